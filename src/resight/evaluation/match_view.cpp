// SPDX-License-Identifier: Apache-2.0
#include "resight/evaluation/match_view.hpp"

#include <algorithm>

#include "resight/evaluation/out_of_image.hpp"

namespace resight {

std::vector<DetectedObject> to_detected_objects(const SceneUpdate& update, const ModelLibrary& library) {
  const Rigid3 camera_from_world = update.world_from_camera.inverse();
  std::vector<DetectedObject> objects;
  for (const Detection& detection : update.detections)
    objects.push_back(
        {library.object(detection.object).name, camera_from_world * detection.world_from_object, detection.score});
  return objects;
}

MatchedView match_view(int view, const TruthView& truth, std::span<const DetectedObject> detections,
                       std::span<const FormerPlace> former_places, const Camera& camera, const ModelLibrary& library,
                       const MatchDetectionsOptions& options) {
  MatchDetectionsOptions strict_options = strict_match_options();
  strict_options.min_visible_share = options.min_visible_share;
  MatchedView matched;
  matched.loose = match_detections(truth.objects, detections, library, options);
  matched.strict = match_detections(truth.objects, detections, library, strict_options);
  for (MatchDetectionsResult* result : {&matched.loose, &matched.strict})
    ignore_out_of_image(*result, detections, camera, library, options.min_visible_share);
  matched.ghosts = find_ghosts(former_places, truth, view, detections, camera, library, options);
  std::erase_if(matched.ghosts, [&](const Ghost& ghost) {
    return !std::ranges::binary_search(matched.loose.false_positives, ghost.detection);
  });
  return matched;
}

}  // namespace resight
