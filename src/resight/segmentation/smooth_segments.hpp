// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <span>
#include <vector>

namespace resight {

struct SmoothSegmentsOptions {
  double max_distance_m = 0.01;  ///< Largest distance of neighbours.
  double max_angle_rad = 0.25;   ///< Largest angle between the normals of neighbours.
  double max_curvature = 0.04;   ///< 1 - |mean normal| within max_distance_m.
  int min_points = 100;          ///< Smaller segments are dropped.
  int num_threads = 1;           ///< Same bits for any value >= 1.
  void check() const;
};

struct SmoothSegments {
  std::vector<int> segment;  ///< Per point; -1 = in no segment.
  int num_segments = 0;
};

/// Smooth segments of an unorganised cloud: points within max_distance_m are joined when their normals differ by
/// less than max_angle_rad and both lie in flat surroundings (max_curvature); a point on an edge goes to the
/// neighbour whose normal is nearest. The joining is a union, so that unlike region growing from seeds the result does
/// not depend on an order. Fewer than min_points: no segment. Numbered by first point. Points of zero normal are
/// in none.
[[nodiscard]] SmoothSegments find_smooth_segments(std::span<const Eigen::Vector3f> points,
                                                  std::span<const Eigen::Vector3f> normals,
                                                  const SmoothSegmentsOptions& options);

}  // namespace resight
