// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <span>
#include <vector>

#include "resight/cameras/view_tracker.hpp"
#include "resight/models/observed_object.hpp"
#include "resight/models/pose_distance.hpp"

namespace resight {

/// A place at which views of one component observe an object.
struct ObjectPlace {
  int object = -1;
  int component = 0;
  Rigid3 component_from_object;   ///< Pose of the medoid of the observations.
  std::vector<int> observations;  ///< Ascending indices of the input; the view of the first represents the place.
};

/// Groups observations of an object at the same pose, per component. Sorted by component, then by first observation.
/// Throws std::invalid_argument if an observation refers to a view or an object that does not exist.
[[nodiscard]] std::vector<ObjectPlace> find_places(const CameraTrack& track, std::span<const ObservedObject> observed,
                                                   const ModelLibrary& library, const SamePlaceOptions& options = {});

}  // namespace resight
