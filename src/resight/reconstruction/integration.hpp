// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <span>
#include <vector>

#include "resight/geometry/point_cloud.hpp"
#include "resight/reconstruction/view_voxels.hpp"
#include "resight/sensor/prepared_view.hpp"

namespace resight {

/// Alg. 1, line 5: the view without the points within `tolerance_m` of `removed_in_world`. Depth, points and normals
/// become NaN there (the colour stays), and edges and noise are computed anew, so that the rim of the hole counts as an
/// edge. The normals of the points that stay are those they had: `prepare` gives the edge options and the threads. The
/// view is returned unchanged if nothing is near.
[[nodiscard]] PreparedView clear_removed_points(PreparedView view, const PointCloud& removed_in_world,
                                                double tolerance_m, const PrepareViewOptions& prepare = {});

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

/// The second half of it: the winners over all views, again and again as views come and go. Keeps its memory.
class VoxelMerger {
 public:
  /// `views` must have been reduced with the same voxel size and VoxelNumbers. `result` is overwritten.
  void merge(std::span<const ViewVoxels* const> views, const IntegrateOptions& options, Reconstruction& result);

 private:
  struct Winner {
    int number;
    int view;
    int slot;
    float noise;
  };
  void find_winners(std::span<const ViewVoxels* const> views);
  void drop_rare(std::span<const ViewVoxels* const> views, int min_points);

  std::vector<int> winner_of_number_;  // Position in winners_ if that is of the number; else left from another time.
  std::vector<Winner> winners_;        // In the order of the voxels' first points, view by view.
};

}  // namespace resight
