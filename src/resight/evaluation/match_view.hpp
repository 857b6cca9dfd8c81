// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <span>
#include <vector>

#include "resight/evaluation/ghosts.hpp"
#include "resight/evaluation/match_detections.hpp"
#include "resight/geometry/camera.hpp"
#include "resight/recognition/scene_recognizer.hpp"

namespace resight {

/// Detections of a view in the camera frame, by name, as input of the evaluation.
[[nodiscard]] std::vector<DetectedObject> to_detected_objects(const SceneUpdate& update, const ModelLibrary& library);

/// Verdicts on the detections of one view.
struct MatchedView {
  MatchDetectionsResult loose;   ///< Within the limits of the options: 5 cm and 30 deg by default.
  MatchDetectionsResult strict;  ///< Within 1 cm and 10 deg.
  std::vector<Ghost> ghosts;     ///< Among the false positives of `loose`.
};

/// Matches the detections of view number `view` to its ground truth. Detections outside the image are ignored. Throws
/// std::invalid_argument for a detection whose object is not in the library.
[[nodiscard]] MatchedView match_view(int view, const TruthView& truth, std::span<const DetectedObject> detections,
                                     std::span<const FormerPlace> former_places, const Camera& camera,
                                     const ModelLibrary& library, const MatchDetectionsOptions& options = {});

}  // namespace resight
