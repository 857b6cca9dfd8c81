// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <numbers>

namespace resight {

/// Converts degrees to radians.
[[nodiscard]] constexpr double radians(double degrees) { return degrees * std::numbers::pi / 180; }

}  // namespace resight
