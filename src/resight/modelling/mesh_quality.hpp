// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "resight/geometry/triangle_mesh.hpp"

namespace resight {

/// Holes of a mesh: closed loops of edges with a face on one side only.
struct MeshHoles {
  int count = 0;                 ///< Number of holes with a rim of at least 2 cm.
  double boundary_length_m = 0;  ///< Length of all open edges.
  double area_sq_m = 0;          ///< Area of all holes, each closed by a triangle fan about its middle.
  double open_share = 0;         ///< Share of the hole area in the sum of hole and surface area.
};
/// Finds and measures the holes of a mesh. Chains of open edges that meet at a vertex may be split there.
[[nodiscard]] MeshHoles measure_holes(const TriangleMesh& mesh);

/// Area of all faces, m^2.
[[nodiscard]] double surface_area(const TriangleMesh& mesh);

/// Removes connected components with fewer faces than `min_share` of the largest one, and unused vertices. Attributes
/// are kept.
[[nodiscard]] TriangleMesh keep_large_parts(const TriangleMesh& mesh, double min_share);

}  // namespace resight
