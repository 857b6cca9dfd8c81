// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "resight/geometry/point_cloud.hpp"
#include "resight/geometry/triangle_mesh.hpp"

namespace resight {

/// Points on those parts of a mesh that can be seen from outside, one per cube of side `spacing_m`, with outward
/// normals and colours: a complete model as scanners deliver it. Deterministic.
[[nodiscard]] PointCloud sample_visible_surface(const TriangleMesh& mesh, double spacing_m = 0.002);

}  // namespace resight
