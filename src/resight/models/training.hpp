// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <span>

#include "resight/core/result.hpp"
#include "resight/features/shot.hpp"
#include "resight/features/sift.hpp"
#include "resight/geometry/triangle_mesh.hpp"
#include "resight/models/object_model.hpp"
#include "resight/sensor/rgbd_frame.hpp"
#include "resight/simulation/turntable.hpp"

namespace resight {

struct TrainOptions {
  SiftOptions sift;
  ShotOptions shot{.min_surface_variation = 0.0};  ///< On an object every keypoint counts.
  double surface_voxel_m = 0.003;                  ///< V4R voxelises models at 3 mm.
  TurntableOptions turntable;                      ///< For meshes: the views they are ray-cast from.
  int num_threads = 1;                             ///< Not part of the hash: the bytes do not depend on it.
  void check() const;
  [[nodiscard]] std::uint64_t hash() const;        ///< Of every field that changes the result, and of the format version.
};

/// Trains from registered views (frame.world_from_camera is object_from_camera; mask: non-zero = object).
[[nodiscard]] Result<ObjectModel> train_object(const std::string& name, std::span<const TrainingView> views, const TrainOptions& options = {});

/// Trains from a mesh: its views are ray-cast, its surface is sampled from the triangles.
[[nodiscard]] Result<ObjectModel> train_object(const std::string& name, const TriangleMesh& mesh, const TrainOptions& options = {});

}  // namespace resight
