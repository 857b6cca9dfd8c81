// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "resight/geometry/triangle_mesh.hpp"

namespace resight {

/// Holes of a mesh: closed ways along edges that have a face on one side only.
struct MeshHoles {
  int count = 0;                 ///< Of those around which it is 2 cm or more.
  double boundary_length_m = 0;  ///< Of all open edges.
  double area_sq_m = 0;          ///< Of all holes, each closed by a fan about its middle.
  double open_share = 0;         ///< Of hole area in hole and surface area together.
};
[[nodiscard]] MeshHoles measure_holes(const TriangleMesh& mesh);

/// Area of all faces, square metres.
[[nodiscard]] double surface_area(const TriangleMesh& mesh);

/// Without the connected parts that have fewer faces than `min_share` of the largest one, and without vertices that no
/// face uses. Attributes are kept.
[[nodiscard]] TriangleMesh keep_large_parts(const TriangleMesh& mesh, double min_share);

}  // namespace resight
