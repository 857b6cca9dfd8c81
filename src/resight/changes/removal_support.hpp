// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <span>
#include <vector>

#include "resight/changes/difference.hpp"
#include "resight/geometry/point_cloud.hpp"
#include "resight/geometry/rigid3.hpp"

namespace resight {

struct RemovalSupportOptions {
  double cluster_distance_m = 0.03;  ///< Removed points nearer than this are one cluster (V4R).
  int min_cluster_points = 50;       ///< V4R: 50.
  double model_distance_m = 0.02;    ///< A removed point this near the object's surface speaks for its removal.
  double min_overlap = 0.8;          ///< Share of a cluster's points that must lie there (V4R: 0.8).
  int min_support_points = 50;       ///< More than this in sum: the object is gone (V4R: 50).
  void check() const;
};

/// Euclidean clusters: points are in one cluster if a chain of points joins them, each step at most `distance_m` long.
/// Clusters of at least `min_points`, in the order of their first point; indices ascending. NaN points are in none.
[[nodiscard]] std::vector<std::vector<int>> cluster_points(std::span<const Eigen::Vector3f> points, double distance_m,
                                                           int min_points);

/// Number of removed points that say "this object is gone": points of those Euclidean clusters of `removed_in_world`
/// that lie for more than min_overlap on the surface of the object at its pose (`surface_in_world`).
[[nodiscard]] int count_removal_support(const PointCloud& surface_in_world, const PointCloud& removed_in_world,
                                        const RemovalSupportOptions& options = {});

/// The same for clusters that stand already (cluster_points() with the options' distance and size) and for the surface
/// of the object in its own frame, on a grid of model_distance_m: for many poses against one set of removed points.
[[nodiscard]] int count_removal_support(const ProximityGrid& surface_in_object, const Rigid3& object_from_world,
                                        const PointCloud& removed_in_world, std::span<const std::vector<int>> clusters,
                                        const RemovalSupportOptions& options = {});

}  // namespace resight
