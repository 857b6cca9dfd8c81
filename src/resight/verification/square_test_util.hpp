// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <vector>

namespace resight::test {

inline constexpr int kSide = 20;  ///< Points along each side of square().
inline constexpr float kSpacing_m = 0.005F;

/// Points of a flat square, row by row.
inline std::vector<Eigen::Vector3f> square() {
  std::vector<Eigen::Vector3f> points;
  for (int i = 0; i < kSide * kSide; ++i)
    points.emplace_back(kSpacing_m * static_cast<float>(i % kSide), kSpacing_m * static_cast<float>(i / kSide), 0);
  return points;
}

}  // namespace resight::test
