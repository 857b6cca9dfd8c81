// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <span>

#include "resight/geometry/triangle_mesh.hpp"
#include "resight/sensor/training_view.hpp"

namespace resight {

/// All values are ours.
struct FuseViewsOptions {
  double voxel_m = 0.0015;            ///< Finer than the noise of one view, as many views are averaged.
  double truncation_m = 0.005;        ///< Of distances: beyond the noise of a point, thinner than most walls.
  double min_edge_distance_px = 2.0;  ///< Points nearer to a depth discontinuity are mixtures with the background.
  double max_incidence_rad = 1.3;     ///< Surface slanted more (75 deg) is not used.
  double min_weight = 0.4;            ///< Of what is surface, in 1/mm^2: one good point at 0.8 m.
  /// A place is free if the weight of the views that see through it exceeds this multiple of that of those that see it.
  double max_free_share = 1.0;
  double color_from = 0.6;            ///< Of the views of a vertex, in order of brightness: the share that gives its
  double color_to = 0.9;              ///< colour. 0 and 1: the mean of all.
  double min_component_share = 0.05;  ///< Of the largest part's faces; smaller loose parts are dropped.
  int num_threads = 1;                ///< Same bits for any value >= 1.
  void check() const;
};

/// Fuses masked views of an object (frame.world_from_camera is object_from_camera; mask: non-zero = object) into a mesh
/// in the object frame, with normals and vertex colours. Views are integrated into a truncated signed distance field
/// (Curless and Levoy 1996), weighted by the inverse variance of their points (nguyen_noise()); surface nets extract
/// the mesh. Unobserved places remain open. Free space, including that in front of the background, is carved. Empty if
/// no view has a usable point of the object.
[[nodiscard]] TriangleMesh fuse_views(std::span<const TrainingView> views, const FuseViewsOptions& options = {});

}  // namespace resight
