// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "resight/geometry/point_cloud.hpp"
#include "resight/geometry/triangle_mesh.hpp"

namespace resight {

inline constexpr double kMaxSurfaceSamples = 1e7;

/// Samples the surface of a mesh evenly with `samples_per_sq_m` points per area, by a low-discrepancy sequence (no
/// seed). Points have the colours of the mesh, and its normals, or face normals if it has none. All normals point
/// outwards: those of a mesh with negative signed volume are flipped. Faces without area get no points. Of a mesh that
/// would get more than kMaxSurfaceSamples, fewer points per area are taken.
[[nodiscard]] PointCloud sample_surface(const TriangleMesh& mesh, double samples_per_sq_m);

}  // namespace resight
