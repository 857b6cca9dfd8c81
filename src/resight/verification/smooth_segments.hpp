// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <span>
#include <vector>

#include "resight/verification/verification.hpp"

namespace resight {

struct SmoothSegments {
  std::vector<int> segment;  ///< Per point; -1 = in no segment.
  int num_segments = 0;
};

/// Smooth segments of an unorganised cloud: points within smooth_distance_m are joined when their normals differ by
/// less than smooth_angle_rad and both lie in flat surroundings (max_smooth_curvature); a point on an edge goes to the
/// neighbour whose normal is nearest. The joining is a union, so that unlike region growing from seeds the result does
/// not depend on an order. Fewer than min_smooth_points: no segment. Numbered by first point. Points of zero normal are
/// in none.
[[nodiscard]] SmoothSegments find_smooth_segments(std::span<const Eigen::Vector3f> points,
                                                  std::span<const Eigen::Vector3f> normals,
                                                  const VerifyOptions& options);

}  // namespace resight
