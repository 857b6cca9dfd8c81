// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <span>
#include <string>
#include <vector>

#include "resight/evaluation/match_detections.hpp"
#include "resight/geometry/camera.hpp"
#include "resight/geometry/rigid3.hpp"

namespace resight {

/// A place that an object stood at and has left, by the ground truth.
struct FormerPlace {
  std::string object;
  Rigid3 world_from_object;
  int last_view = 0;  ///< Last view in which the object stood there; it is a former place from the next view on.
};

/// What the ground truth says of one view, in time order.
struct TruthView {
  Rigid3 world_from_camera;
  std::vector<GroundTruthObject> objects;
};

struct FindFormerPlacesOptions {
  double max_center_distance_m =
      0.01;                            ///< Nearer annotations of one object are the same placement: annotations jitter.
  double max_rotation_rad = 0.174533;  ///< 10 deg.
  void check() const;
};

/// The placements that end before the last view, in order of their first view. An object that is out of the annotations
/// for a while and then back at the same place had not left it. An object missing since some view counts as gone from
/// there: see find_ghosts() for the places that a later view does not look at. Objects that are not in the library are
/// left out.
[[nodiscard]] std::vector<FormerPlace> find_former_places(std::span<const TruthView> views, const ModelLibrary& library,
                                                          const FindFormerPlacesOptions& options = {});

/// A detection at a place that its object has left.
struct Ghost {
  int detection = -1;
  int place = -1;  ///< Index into the former places.
  PoseDifference difference;
};

/// The ghosts among the detections of view number `view` (paper, Fig. 5: false detections caused by a change), by
/// ascending detection.
///
/// A detection is a ghost when it is within the limits of a former place of its object (of several, the nearest) and of
/// NO present truth, however hidden or already claimed: an object of the same kind put there is no ghost. Deviation
/// from the paper's protocol, which counts every detection at an old place: places whose centre `camera` does not see
/// in this view say nothing and are left out.
[[nodiscard]] std::vector<Ghost> find_ghosts(std::span<const FormerPlace> places, const TruthView& truth, int view,
                                             std::span<const DetectedObject> detections, const Camera& camera,
                                             const ModelLibrary& library, const MatchDetectionsOptions& options = {});

}  // namespace resight
