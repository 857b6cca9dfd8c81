// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <span>

#include "resight/evaluation/match_detections.hpp"
#include "resight/geometry/camera.hpp"

namespace resight {

/// Share of the object's surface points that project into the image, occluded or not. Uses the centre if the model has
/// no surface.
[[nodiscard]] double share_in_image(const ObjectModel& model, const Rigid3& camera_from_object, const Camera& camera);

/// Moves false positives outside the image to the ignored detections: those with less than `min_visible_share` of the
/// object inside. The ground truth of a view lists only objects in the image, but a multi-view recogniser rightly
/// reports objects that only earlier views observed.
void ignore_out_of_image(MatchDetectionsResult& result, std::span<const DetectedObject> detections,
                         const Camera& camera, const ModelLibrary& library, double min_visible_share);

}  // namespace resight
