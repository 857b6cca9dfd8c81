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

/// A cloud with normals and colours as a mesh that can be ray-cast: each point becomes a hexagon in its tangent plane,
/// as large as the distance to its sixth neighbour, so that the discs of an evenly sampled surface overlap without
/// gaps. Colours and normals at the corners are Gaussian means over the points around (surface splatting, Zwicker et
/// al. 2001): where discs overlap they agree, whichever is hit. Normals of discs point as those of the points, whose
/// other side (more than 90 deg away) has no part in a mean. Neither a closed nor a manifold surface.
[[nodiscard]] TriangleMesh make_splat_mesh(const PointCloud& cloud, const SplatMeshOptions& options = {});

}  // namespace resight
