// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <span>
#include <vector>

#include "resight/geometry/point_cloud.hpp"
#include "resight/sensor/prepared_view.hpp"

namespace resight {

/// Alg. 1, line 5: the view without the points within `tolerance_m` of `removed_in_world`. Depth, points and normals become
/// NaN there, and edges and noise are computed anew. The view is returned unchanged if nothing is near.
[[nodiscard]] PreparedView clear_removed_points(PreparedView view, const PointCloud& removed_in_world, double tolerance_m,
                                                const PrepareViewOptions& prepare = {});

struct IntegrateOptions {
  double voxel_m = 0.005;
  double min_edge_distance_px = 3.0;   ///< Points nearer to a depth discontinuity are dropped (V4R: 3 px).
  int min_points_per_voxel = 1;
  int num_threads = 1;                 ///< Same bits for any value >= 1.
  void check() const;
};

/// The scene as the views see it: one point a voxel, that of the lowest noise (sigma_L^2 sigma_A), with its normal, colour and view.
struct Reconstruction {
  PointCloud cloud_in_world;         ///< With normals and colours.
  std::vector<float> noise;          ///< sigma_L^2 sigma_A, m^3.
  std::vector<int> view;             ///< Position in the span of views that it came from.
};

/// Alg. 1, line 6 (paper Sec. III-B2). Points without a normal take no part. Views in any order; ties go to the later one.
[[nodiscard]] Reconstruction integrate_views(std::span<const PreparedView* const> views, const IntegrateOptions& options = {});

}  // namespace resight
