// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <span>

#include "resight/evaluation/match_detections.hpp"
#include "resight/geometry/camera.hpp"

namespace resight {

/// Share of the object's surface points (of its centre, where the model has none) that project into the image, hidden
/// or not.
[[nodiscard]] double share_in_image(const ObjectModel& model, const Rigid3& camera_from_object, const Camera& camera);

/// Takes back the verdict on false positives that lie outside of the image: less than `min_visible_share` of the object
/// is within it. The truth of a view tells what is in the image, so it says nothing of them; they become ignored
/// detections. A recogniser of several views rightly reports what only an earlier view looked at.
void ignore_out_of_image(MatchDetectionsResult& result, std::span<const DetectedObject> detections,
                         const Camera& camera, const ModelLibrary& library, double min_visible_share);

}  // namespace resight
