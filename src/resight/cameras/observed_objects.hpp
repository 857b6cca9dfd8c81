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

/// Two poses of an object that are one place of it.
struct SamePlaceOptions {
  double max_distance_m = 0.03;   ///< Between its centres.
  double max_rotation_rad = 0.2;  ///< Up to its symmetries.
  void check() const;
};

[[nodiscard]] bool is_same_place(const ObjectModel& model, const Rigid3& a, const Rigid3& b,
                                 const SamePlaceOptions& options);

/// A place at which views of one part see an object.
struct ObjectPlace {
  int object = -1;
  int part = 0;
  Rigid3 part_from_object;        ///< Of the observation nearest to the others.
  std::vector<int> observations;  ///< Indices, in order; the first one's view stands for the place.
};

/// The places of each part, in order of parts and observations. Throws std::invalid_argument for an observation of a
/// view or an object that does not exist.
[[nodiscard]] std::vector<ObjectPlace> find_places(const CameraTrack& track, std::span<const ObservedObject> observed,
                                                   const ModelLibrary& library, const SamePlaceOptions& options = {});

}  // namespace resight
