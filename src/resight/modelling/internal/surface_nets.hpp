// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "resight/geometry/triangle_mesh.hpp"
#include "resight/modelling/internal/distance_volume.hpp"

namespace resight {

/// What makes a voxel count as known.
struct KnownVoxelRule {
  float min_weight = 0;      ///< Of the surface seen near it.
  float max_free_share = 1;  ///< More weight of views that looked through than this share of the surface's: it is free.
};

/// The zero level of the field as a mesh, faces counter-clockwise from outside (surface nets, Gibson 1998): one vertex
/// in each cube of eight known voxels with both signs, at the mean of the crossings of its edges; one quad for each
/// edge with both signs. Cubes with an unknown corner stay open. No normals, no colours.
[[nodiscard]] TriangleMesh extract_surface_nets(const DistanceVolume& volume, const KnownVoxelRule& rule);

}  // namespace resight
