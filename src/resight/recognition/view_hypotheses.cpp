// SPDX-License-Identifier: Apache-2.0
#include "resight/recognition/view_hypotheses.hpp"

#include <algorithm>
#include <array>
#include <string_view>

namespace resight {

std::string generation_settings(const RecognizerConfig& config) {
  // What follows the hypotheses of a view. All else counts, so that a new setting is not forgotten.
  constexpr std::array<std::string_view, 13> kLaterSections{
      "preset",   "num_previous_views", "detect_changes", "cluster_hypotheses", "clear_tolerance_m", "min_reported_share",
      "cluster.", "changes.",           "removal.",       "integrate.",         "verify.",
      "history.", "presence."};
  std::string text;
  for (const auto& [name, value] : config.to_settings())
    if (std::ranges::none_of(kLaterSections, [&](std::string_view s) { return name.starts_with(s); }))
      text += name + "=" + value + "\n";
  return text;
}

}  // namespace resight
