// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <cmath>
#include <numbers>

namespace resight {

/// The i-th of `count` unit vectors that are spread evenly over the sphere, from +z to -z (Fibonacci lattice).
[[nodiscard]] inline Eigen::Vector3d fibonacci_direction(int i, int count) {
  const double z = 1 - (2 * i + 1.0) / count;
  const double angle_rad = i * std::numbers::pi * (3 - std::sqrt(5.0));
  const double r = std::sqrt(1 - z * z);
  return {r * std::cos(angle_rad), r * std::sin(angle_rad), z};
}

}  // namespace resight
