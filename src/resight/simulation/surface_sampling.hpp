// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "resight/geometry/point_cloud.hpp"
#include "resight/geometry/triangle_mesh.hpp"

namespace resight {

/// Samples the parts of a mesh that are visible from outside, one point per cube of side `spacing_m`, with outward
/// normals and colours. The result resembles a complete scanned model. Deterministic.
[[nodiscard]] PointCloud sample_visible_surface(const TriangleMesh& mesh, double spacing_m = 0.002);

}  // namespace resight
