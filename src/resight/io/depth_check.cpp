// SPDX-License-Identifier: Apache-2.0
#include "resight/io/internal/depth_check.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace resight::io {

Result<void> check_depth_unit(const RgbdFrame& frame) {
  constexpr float kMinMedian_m = 0.1F;
  constexpr float kMaxMedian_m = 20;
  std::vector<float> depths;
  for (const float z : frame.depth_m.data())
    if (!std::isnan(z)) depths.push_back(z);
  if (depths.empty()) return {};
  const auto middle = depths.begin() + std::ssize(depths) / 2;
  std::ranges::nth_element(depths, middle);
  if (*middle >= kMinMedian_m && *middle <= kMaxMedian_m) return {};
  return Error{
      fmt::format("the median depth of view '{}' would be {:.3g} m: the unit is wrong; give --depth-scale "
                  "METRES per stored unit (0.001: millimetres)",
                  frame.name, *middle)};
}

}  // namespace resight::io
