// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <span>

#include "resight/evaluation/evaluated_run.hpp"
#include "resight/evaluation/ghosts.hpp"
#include "resight/evaluation/match_detections.hpp"
#include "resight/geometry/camera.hpp"

namespace resight {

/// Scores what is reported of view number `view` at both pairs of tolerances, and tells the ghosts among the false
/// positives. Fills all but counts, points, times and lost_at. An empty list of detections is a result, too: every
/// visible object is then missed. Truth of objects that are not in the library is left out.
[[nodiscard]] EvaluatedView score_view(int view, const TruthView& truth, std::span<const DetectedObject> detections,
                                       std::span<const FormerPlace> former_places, const Camera& camera,
                                       const ModelLibrary& library, const MatchDetectionsOptions& options = {});

}  // namespace resight
