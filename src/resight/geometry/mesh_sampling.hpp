// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "resight/geometry/point_cloud.hpp"
#include "resight/geometry/triangle_mesh.hpp"

namespace resight {

/// `samples_per_sq_m` points per area, evenly over all triangles (a low-discrepancy sequence: no seed), with the
/// normals of the mesh where it has them, else of the faces, all turned outwards (the mesh counts as inside out if its
/// signed volume is negative), and its colours. Faces without area get none.
[[nodiscard]] PointCloud sample_surface(const TriangleMesh& mesh, double samples_per_sq_m);

}  // namespace resight
