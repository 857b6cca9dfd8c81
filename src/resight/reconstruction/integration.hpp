// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <span>
#include <vector>

#include "resight/geometry/point_cloud.hpp"
#include "resight/reconstruction/view_voxels.hpp"
#include "resight/sensor/prepared_view.hpp"

namespace resight {

/// Removes the points within `tolerance_m` of `removed_in_world` from a view (Alg. 1, line 5). Their depth, point,
/// normal and noise become NaN; the colour stays. The edge distance is updated, so that the rim of the hole counts as a
/// depth edge. The remaining points keep their normals and noise. `prepare` provides the edge options and the number of
/// threads. Returns the view unchanged if no point is near. Throws std::invalid_argument if the view is not prepared.
[[nodiscard]] PreparedView clear_removed_points(PreparedView view, const PointCloud& removed_in_world,
                                                double tolerance_m, const PrepareViewOptions& prepare = {});

/// Reconstruction with one point per voxel: the one with the lowest noise (sigma_L^2 sigma_A), with its normal, colour
/// and view.
struct Reconstruction {
  PointCloud cloud_in_world;  ///< With normals and colours.
  std::vector<float> noise;   ///< sigma_L^2 sigma_A, m^3.
  std::vector<int> view;      ///< Position of its view in the input.
};

/// Merges views into one reconstruction (Alg. 1, line 6; paper, Sec. III-B2). Points without a normal are ignored. The
/// order of the views matters only in ties: the later view wins, and within a view the first pixel. Voxels are ordered
/// by their first point, view by view. Throws std::invalid_argument if a view is null or not prepared.
[[nodiscard]] Reconstruction integrate_views(std::span<const PreparedView* const> views,
                                             const IntegrateOptions& options = {});

/// Second half of integrate_views(): selects the best point per voxel over all views. Reuses its memory between calls.
class VoxelMerger {
 public:
  /// `views` must share the voxel size and VoxelNumbers. `result` is overwritten.
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

  // Position in winners_ if the entry there has this number; otherwise left over from an earlier call.
  std::vector<int> winner_of_number_;
  std::vector<Winner> winners_;  // Ordered by the voxels' first points, view by view.
};

}  // namespace resight
