// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <span>

#include "resight/evaluation/evaluated_run.hpp"
#include "resight/evaluation/ghosts.hpp"
#include "resight/evaluation/match_detections.hpp"
#include "resight/geometry/camera.hpp"

namespace resight {

/// Scores the detections of view `view_number` with both pairs of limits and identifies ghosts among the false
/// positives. Sets all fields except counts, points, times and lost_at. If there are no detections, every visible
/// object is missed. Ground truth of objects that are not in the library is ignored.
[[nodiscard]] EvaluatedView score_view(int view_number, const TruthView& truth,
                                       std::span<const DetectedObject> detections,
                                       std::span<const FormerPlace> former_places, const Camera& camera,
                                       const ModelLibrary& library, const MatchDetectionsOptions& options = {});

}  // namespace resight
