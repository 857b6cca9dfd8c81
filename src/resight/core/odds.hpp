// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <algorithm>

namespace resight {

/// p / (1 - p) of a probability; finite for 1, too.
[[nodiscard]] inline double odds_of(double probability) {
  constexpr double kLargest = 1 - 1e-12;
  const double p = std::min(probability, kLargest);
  return p / (1 - p);
}

}  // namespace resight
