// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <vector>

#include "resight/geometry/rigid3.hpp"
#include "resight/geometry/triangle_mesh.hpp"

namespace resight {

struct AlignShapesOptions {
  int num_directions = 60;            ///< Of the moving surface's axis that are tried.
  int num_rotations = 12;             ///< About each of them.
  int num_samples = 300;              ///< Points of each surface.
  int num_iterations = 15;            ///< Of each trial.
  double max_distance_m = 0.003;      ///< Between points that agree.
  double max_normal_angle_rad = 0.6;  ///< The same of their normals.
  int max_fits = 300;                 ///< That are returned.
  int num_threads = 1;                ///< Same bits for any value >= 1.
};

/// A possible alignment of two surfaces.
struct ShapeFit {
  Rigid3 fixed_from_moving;
  double agreement = 0;  ///< Share of both surfaces' points that agree with the other surface.
};

/// Aligns two surfaces by shape alone: point-to-plane ICP from rotations distributed over all orientations, with the
/// middles of both coincident. Either surface may be partial. Best fit first; fits that differ by less than 1 cm count
/// as one. Empty if a surface has no vertices.
[[nodiscard]] std::vector<ShapeFit> align_shapes(const TriangleMesh& fixed, const TriangleMesh& moving,
                                                 const AlignShapesOptions& options);

}  // namespace resight
