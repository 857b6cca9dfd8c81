// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "resight/geometry/point_cloud.hpp"
#include "resight/geometry/triangle_mesh.hpp"

namespace resight {

struct SplatMeshOptions {
  int num_neighbors = 16;   ///< That a disc takes its size, its colours and the normals of its rim from.
  double max_growth = 3.0;  ///< No disc is larger than this many times the median one: lone points stay small.
  int num_threads = 1;      ///< Same bits for any value >= 1.
  void check() const;
};

/// Converts a cloud with normals and colours to a mesh for ray casting (surface splatting, Zwicker et al. 2001). Each
/// point becomes a hexagon in its tangent plane with the distance to its sixth neighbour as radius, so that the discs
/// of an evenly sampled surface overlap without gaps. Colours and normals at the corners are Gaussian means over the
/// surrounding points, so overlapping discs agree and the result does not depend on which one is hit. Points whose
/// normals differ by more than 90 deg (the other side of a thin wall) are excluded from a mean. The mesh is neither
/// closed nor manifold. Throws std::invalid_argument for fewer than three points, missing normals or colours, or if
/// most points coincide.
[[nodiscard]] TriangleMesh make_splat_mesh(const PointCloud& cloud, const SplatMeshOptions& options = {});

}  // namespace resight
