// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "resight/geometry/point_cloud.hpp"
#include "resight/geometry/voxel_map.hpp"
#include "resight/sensor/prepared_view.hpp"

namespace resight {

/// Alg. 1, line 5: the view without the points within `tolerance_m` of `removed_in_world`. Depth, points and normals
/// become NaN there (the colour stays), and edges and noise are computed anew, so that the rim of the hole counts as an
/// edge. The normals of the points that stay are those they had: `prepare` gives the edge options and the threads. The
/// view is returned unchanged if nothing is near.
[[nodiscard]] PreparedView clear_removed_points(PreparedView view, const PointCloud& removed_in_world,
                                                double tolerance_m, const PrepareViewOptions& prepare = {});

struct IntegrateOptions {
  double voxel_m = 0.005;
  double min_edge_distance_px = 3.0;  ///< Points nearer to a depth discontinuity are dropped (V4R: 3 px).
  int min_points_per_voxel = 1;       ///< Of all views together.
  int num_threads = 1;                ///< Same bits for any value >= 1.
  void check() const;
};

/// The scene as the views see it: one point a voxel, that of the lowest noise (sigma_L^2 sigma_A), with its normal,
/// colour and view.
struct Reconstruction {
  PointCloud cloud_in_world;  ///< With normals and colours.
  std::vector<float> noise;   ///< sigma_L^2 sigma_A, m^3.
  std::vector<int> view;      ///< Position in the span of views that it came from.
};

/// Alg. 1, line 6 (paper Sec. III-B2). Points without a normal take no part. Views in any order; ties go to the later
/// one. Within a view, ties go to the first pixel; voxels stand in the order of their first point, view by view.
[[nodiscard]] Reconstruction integrate_views(std::span<const PreparedView* const> views,
                                             const IntegrateOptions& options = {});

/// What a single view has to say, one point a voxel: the first and dearer half of integrate_views(). Depends on the
/// view alone, so that a view that stays as it is need not be reduced again for the next reconstruction.
struct ViewVoxels {
  std::vector<std::uint64_t> keys;  ///< voxel_key() in the world frame, in the order of the voxels' first pixels.
  PointCloud cloud_in_world;        ///< The point of the lowest noise of each, with normal and colour.
  std::vector<float> noise;         ///< sigma_L^2 sigma_A, m^3.
  std::vector<int> num_points;      ///< Points of the view in the voxel.
  std::vector<int> voxel_of_pixel;  ///< Position in `keys`, or -1.
  std::vector<int> numbers;         ///< Of the voxels, the same in all views that VoxelNumbers has seen; empty before.
};
[[nodiscard]] ViewVoxels reduce_to_voxels(const PreparedView& view, const IntegrateOptions& options = {});

/// The same of a view from which points were taken since it was reduced, without looking up what did not change.
/// Numbers are kept, unless voxels have come (with an edge, the points beside it may come in).
[[nodiscard]] ViewVoxels reduce_again(const PreparedView& view, const ViewVoxels& before,
                                      const IntegrateOptions& options = {});

/// Numbers voxels, 0, 1, 2, .. as they come: a view is looked up in the hash table once, and not for each
/// reconstruction that it takes part in.
class VoxelNumbers {
 public:
  void assign_to(ViewVoxels& view);
  [[nodiscard]] std::size_t size() const { return voxels_.size(); }

 private:
  VoxelMap voxels_;
};

/// The second half: the winners over all views. `views` must have been reduced with the same voxel size, and numbered
/// by the same VoxelNumbers.
[[nodiscard]] Reconstruction merge_voxels(std::span<const ViewVoxels* const> views,
                                          const IntegrateOptions& options = {});

}  // namespace resight
