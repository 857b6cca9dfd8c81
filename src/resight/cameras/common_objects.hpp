// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <span>
#include <vector>

#include "resight/cameras/view_tracker.hpp"
#include "resight/models/object_model.hpp"

namespace resight {

/// An object recognised in a single view.
struct ObservedObject {
  int view = 0;
  int object = -1;  ///< Index into the ModelLibrary.
  Rigid3 camera_from_object;
};

struct JoinByObjectsOptions {
  int min_objects = 2;            ///< That must agree on how two parts lie: one may have moved between them.
  double max_distance_m = 0.03;   ///< Between the two places of an object that agrees.
  double max_rotation_rad = 0.2;  ///< The same, of rotations, up to its symmetries.
  double sigma_m = 0.004;         ///< Of a recognised pose.
  double sigma_rad = 0.035;
  void check() const;
};

/// Joins parts of a track that see the same objects, however little their views overlap (paper, Sec. III: "common
/// object hypotheses"). Each object seen in both parts, with each of its symmetries, says how they lie; what most of
/// them agree on joins them. An edge for each join is added to the track. Throws std::invalid_argument for an
/// observation of a view or an object that does not exist.
[[nodiscard]] CameraTrack join_by_objects(CameraTrack track, std::span<const ObservedObject> observed,
                                          const ModelLibrary& library, const JoinByObjectsOptions& options = {});

}  // namespace resight
