// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <span>
#include <vector>

#include "resight/changes/difference.hpp"
#include "resight/core/options.hpp"
#include "resight/geometry/point_cloud.hpp"
#include "resight/geometry/rigid3.hpp"

namespace resight {

struct RemovalSupportOptions {
  double cluster_distance_m = 0.03;
  int min_cluster_points = 50;
  double model_distance_m = 0.02;
  double min_overlap = 0.8;
  int min_support_points = 50;
  void check() const { check_options("RemovalSupportOptions", *this); }
};

inline void declare(OptionVisitor& v, RemovalSupportOptions& o) {
  v.field("cluster_distance_m", o.cluster_distance_m, positive(), "Removed points nearer to each other form a cluster.",
          "V4R");
  v.field("min_cluster_points", o.min_cluster_points, at_least(1), "Smaller clusters are noise.", "V4R");
  v.field("model_distance_m", o.model_distance_m, positive(),
          "A removed point within this distance of an object's surface supports its removal.");
  v.field("min_overlap", o.min_overlap, between(0, 1),
          "Least share of a cluster that must be so near for the cluster to count.", "V4R");
  v.field("min_support_points", o.min_support_points, at_least(0),
          "With more supporting points than this, the object is removed.", "V4R");
}

/// Euclidean clusters: points are in one cluster if a chain of points joins them, each step at most `distance_m` long.
/// Clusters of at least `min_points`, in the order of their first point; indices ascending. NaN points are in none.
[[nodiscard]] std::vector<std::vector<int>> cluster_points(std::span<const Eigen::Vector3f> points, double distance_m,
                                                           int min_points);

/// Number of removed points that say "this object is gone": points of those Euclidean clusters of `removed_in_world`
/// that lie for more than min_overlap on the surface of the object at its pose (`surface_in_world`).
[[nodiscard]] int count_removal_support(const PointCloud& surface_in_world, const PointCloud& removed_in_world,
                                        const RemovalSupportOptions& options = {});

/// The same for clusters that are known already (cluster_points() with the options' distance and size) and for the
/// surface of the object in its own frame, on a grid of model_distance_m: for many poses against one set of removed
/// points.
[[nodiscard]] int count_removal_support(const ProximityGrid& surface_in_object, const Rigid3& object_from_world,
                                        const PointCloud& removed_in_world, std::span<const std::vector<int>> clusters,
                                        const RemovalSupportOptions& options = {});

}  // namespace resight
