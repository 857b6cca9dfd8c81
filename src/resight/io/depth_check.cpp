// SPDX-License-Identifier: Apache-2.0
#include "resight/io/internal/depth_check.hpp"

#include <fmt/format.h>

#include <cmath>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "resight/core/statistics.hpp"

namespace resight::io {
namespace {

/// Of the factors between usual units (1 m, 1 mm, 0.2 mm, 0.1 mm), the first that gives the depth of a table or a room.
std::optional<double> find_likely_factor(double median_m) {
  for (const double factor : {0.1, 0.2, 0.001, 0.0002, 0.0001, 10.0, 5.0, 1000.0, 5000.0, 10000.0})
    if (median_m * factor >= 0.3 && median_m * factor <= 5) return factor;
  return std::nullopt;
}

}  // namespace

Result<void> check_depth_unit(const RgbdFrame& frame) {
  constexpr float kMinMedian_m = 0.1F;
  constexpr float kMaxMedian_m = 20;
  std::vector<float> depths;
  for (const float z : frame.depth_m.data())
    if (!std::isnan(z)) depths.push_back(z);
  if (depths.empty()) return {};
  const float median_m = upper_median(std::move(depths));
  if (median_m >= kMinMedian_m && median_m <= kMaxMedian_m) return {};
  std::string error = fmt::format(
      "the median depth of view '{}' would be {:.3g} m: the unit is wrong; give --depth-scale METRES per stored unit "
      "(0.001: millimetres)",
      frame.name, median_m);
  if (const auto factor = find_likely_factor(median_m))
    error += fmt::format("; {:g} times the unit in use gives {:.3g} m", *factor, *factor * median_m);
  return Error{error};
}

}  // namespace resight::io
