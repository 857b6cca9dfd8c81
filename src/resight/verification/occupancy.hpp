// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <span>
#include <vector>

#include "resight/geometry/point_cloud.hpp"
#include "resight/geometry/rigid3.hpp"

namespace resight {

/// A complete model at its pose.
struct PlacedModel {
  const PointCloud* surface_in_object = nullptr;
  Rigid3 world_from_object;
};

/// Voxels that the surfaces of two models share. a < b.
struct SharedVoxels {
  int a = -1;
  int b = -1;
  int count = 0;
};

/// Pairs of models whose COMPLETE surfaces fill the same voxels, ascending by (a, b). A voxel where the two surfaces
/// face each other (normals' dot product below -0.5) is not counted: there the models touch, as things on a table do,
/// and do not interpenetrate.
[[nodiscard]] std::vector<SharedVoxels> count_shared_voxels(std::span<const PlacedModel> models, double voxel_m,
                                                            int num_threads);

}  // namespace resight
