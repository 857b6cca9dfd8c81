// SPDX-License-Identifier: Apache-2.0
#include "resight/recognition/view_hypotheses.hpp"

#include <algorithm>
#include <array>
#include <string_view>

namespace resight {

std::string generation_settings(const RecognizerConfig& config) {
  // What follows the hypotheses of a view. All else counts, so that a new setting is not forgotten.
  constexpr std::array<std::string_view, 16> kLaterSections{"preset",
                                                            "num_previous_views",
                                                            "detect_changes",
                                                            "cluster_hypotheses",
                                                            "clear_tolerance_m",
                                                            "min_reported_share",
                                                            "min_carried_share",
                                                            "remember_objects",
                                                            "attention.",
                                                            "cluster.",
                                                            "changes.",
                                                            "removal.",
                                                            "integrate.",
                                                            "verify.",
                                                            "history.",
                                                            "presence."};
  // Shapes are checked with the colours of the verification.
  constexpr std::array<std::string_view, 3> kColors{"verify.color_", "verify.light_", "verify.min_inlier_weight"};
  const auto starts_with_one_of = [](const std::string& name, const auto& sections) {
    return std::ranges::any_of(sections, [&](std::string_view s) { return name.starts_with(s); });
  };
  std::string text;
  for (const auto& [name, value] : config.to_settings())
    if (!starts_with_one_of(name, kLaterSections) || starts_with_one_of(name, kColors))
      text += name + "=" + value + "\n";
  return text;
}

}  // namespace resight
