// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <span>
#include <vector>

#include "resight/cameras/view_tracker.hpp"
#include "resight/models/observed_object.hpp"
#include "resight/models/pose_distance.hpp"

namespace resight {

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
