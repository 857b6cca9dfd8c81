// SPDX-License-Identifier: Apache-2.0
#include "resight/evaluation/out_of_image.hpp"

#include <algorithm>

namespace resight {

double share_in_image(const ObjectModel& model, const Rigid3& camera_from_object, const Camera& camera) {
  const auto is_inside = [&](const Eigen::Vector3f& p_in_object) {
    return camera.pixel_of(camera_from_object * p_in_object.cast<double>().eval()).has_value();
  };
  if (model.surface.empty()) return is_inside(model.center) ? 1.0 : 0.0;
  const auto count = std::ranges::count_if(model.surface.points, is_inside);
  return static_cast<double>(count) / static_cast<double>(model.surface.size());
}

void ignore_out_of_image(MatchDetectionsResult& result, std::span<const DetectedObject> detections,
                         const Camera& camera, const ModelLibrary& library, double min_visible_share) {
  const auto is_outside = [&](int d) {
    const DetectedObject& detection = detections[static_cast<std::size_t>(d)];
    const ObjectModel& model = library.objects[static_cast<std::size_t>(library.find(detection.object))];
    return share_in_image(model, detection.camera_from_object, camera) < min_visible_share;
  };
  const auto begin = result.false_positives.begin();
  const auto inside = std::stable_partition(begin, result.false_positives.end(), is_outside);
  result.ignored_detections.insert(result.ignored_detections.end(), begin, inside);
  result.false_positives.erase(begin, inside);
  std::ranges::sort(result.ignored_detections);
  result.score.false_positives = static_cast<int>(result.false_positives.size());
}

}  // namespace resight
