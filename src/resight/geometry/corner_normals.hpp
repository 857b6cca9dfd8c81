// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>

#include "resight/geometry/triangle_mesh.hpp"

namespace resight {

/// The normals to interpolate over a face: those of its vertices. A large face at a sharp edge has its own normal at
/// all corners instead. Vertices that it shares with the faces beyond the edge have the mean of all, which would spread
/// over the whole face. The mesh must have vertex normals.
[[nodiscard]] std::array<Eigen::Vector3f, 3> corner_normals(const TriangleMesh& mesh, int face);

}  // namespace resight
