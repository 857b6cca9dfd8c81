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

/// The segment of each point of a cloud.
struct SmoothSegments {
  std::vector<int> segment;  ///< Per point; -1 if the point is in no segment.
  int num_segments = 0;
};

/// Finds smooth segments of an unorganised cloud. Points within max_distance_m are joined if their normals differ by
/// less than max_angle_rad and both lie in flat surroundings (max_curvature). A point on an edge joins the neighbour
/// with the most similar normal. Joining is a union, so unlike seeded region growing, the result does not depend on an
/// order. Segments with fewer than min_points points are dropped. Segments are numbered by their first points. Points
/// with zero normals are in no segment.
[[nodiscard]] SmoothSegments find_smooth_segments(std::span<const Eigen::Vector3f> points,
                                                  std::span<const Eigen::Vector3f> normals,
                                                  const SmoothSegmentsOptions& options);

}  // namespace resight
