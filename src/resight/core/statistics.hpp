// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <algorithm>
#include <cstddef>
#include <limits>
#include <vector>

namespace resight {

/// Standard deviation of a normal distribution, divided by the median absolute deviation from its median.
inline constexpr double kNormalizedMad = 1.4826;

/// The middle value; of an even number of values, the upper one of the two in the middle. NaN without values. No value
/// may be NaN.
template <typename Number>
[[nodiscard]] Number upper_median(std::vector<Number> values) {
  if (values.empty()) return std::numeric_limits<Number>::quiet_NaN();
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace resight
