// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "resight/geometry/triangle_mesh.hpp"
#include "resight/modelling/internal/distance_volume.hpp"

namespace resight {

/// Decides which voxels count as known.
struct KnownVoxelRule {
  float min_weight = 0;  ///< Least weight of the surface observed near the voxel.
  /// A voxel is free if its free-space weight exceeds this multiple of its surface weight.
  float max_free_share = 1;
};

/// Extracts the zero level of the field as a mesh (surface nets, Gibson 1998), with faces counter-clockwise as seen
/// from outside. A cube of eight known voxels with both signs has one vertex, at the mean of the zero crossings of its
/// edges; an edge with both signs has one quad. Cubes with an unknown corner stay open. No normals, no colours.
[[nodiscard]] TriangleMesh extract_surface_nets(const DistanceVolume& volume, const KnownVoxelRule& rule);

}  // namespace resight
