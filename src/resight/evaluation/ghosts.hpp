// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <span>
#include <string>
#include <vector>

#include "resight/evaluation/match_detections.hpp"
#include "resight/geometry/camera.hpp"
#include "resight/geometry/rigid3.hpp"

namespace resight {

/// A place that an object has left, according to the ground truth.
struct FormerPlace {
  std::string object;
  Rigid3 world_from_object;
  /// Last view with the object at the place; a former place from the next view on.
  int last_view = 0;
  /// Whether the truth proves that the object left. If not, it may only have left the image, and find_ghosts() ignores
  /// the place.
  bool is_proven = true;
};

/// Ground truth of one view. Views are in time order.
struct TruthView {
  Rigid3 world_from_camera;
  std::vector<GroundTruthObject> objects;
};

/// Placements that end before the last view, in order of their first view. An object that is missing from the
/// annotations for a while and returns to the same place has not left. An object that is missing from some view on
/// counts as gone, even if later views do not observe the place; find_ghosts() handles those. A placement follows its
/// annotations: the next one within the limits belongs to it. Annotations jitter, given poses drift, and find_ghosts()
/// could not tell nearer places apart. Objects that are not in the library are ignored.
[[nodiscard]] std::vector<FormerPlace> find_former_places(std::span<const TruthView> views, const ModelLibrary& library,
                                                          const MatchDetectionsOptions& limits = {});

/// A detection at a place that its object has left.
struct Ghost {
  int detection = -1;
  int place = -1;  ///< Index into the former places.
  PoseDifference difference;
};

/// Finds the ghosts among the detections of view number `view`, by ascending detection (paper, Fig. 5: false detections
/// caused by a change).
///
/// A detection is a ghost if it is within the limits of a former place of its object (of several, the nearest) and of
/// NO present ground-truth object, however occluded or already matched: an object of the same kind at that place is no
/// ghost. Deviation from the paper, which counts every detection at a former place: places whose centre is outside the
/// image of this view are ignored. Throws std::invalid_argument for objects that are not in the library.
[[nodiscard]] std::vector<Ghost> find_ghosts(std::span<const FormerPlace> places, const TruthView& truth, int view,
                                             std::span<const DetectedObject> detections, const Camera& camera,
                                             const ModelLibrary& library, const MatchDetectionsOptions& options = {});

/// Number of former places at which an object is detected, as the tool published with the paper counts them (Fig. 5):
/// in every later view, former placements are the ground truth to which detections are matched. Unlike find_ghosts(),
/// places outside the image count, and so do places at which an object of the same name stands now.
[[nodiscard]] int count_detected_former_places(std::span<const FormerPlace> places, const Rigid3& world_from_camera,
                                               int view, std::span<const DetectedObject> detections,
                                               const ModelLibrary& library, const MatchDetectionsOptions& options = {});

}  // namespace resight
