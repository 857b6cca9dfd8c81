// SPDX-License-Identifier: Apache-2.0
#include "resight/report/stored_view.hpp"

namespace resight {
namespace {

StoredDetection to_stored_detection(const Detection& detection, const ObjectModel& model, const std::string& verdict) {
  StoredDetection stored;
  stored.object = model.name;
  stored.bop_id = model.bop_id;
  stored.track = detection.track;
  stored.score = detection.score;
  stored.fit = detection.fit;
  stored.visible_share = detection.visible_share;
  stored.world_from_object = detection.world_from_object;
  if (detection.uncertainty.is_known()) {
    auto& numbers = stored.covariance.emplace();
    for (int i = 0; i < 36; ++i) numbers[static_cast<std::size_t>(i)] = detection.uncertainty.covariance(i / 6, i % 6);
  }
  for (const DetectionViewEvidence& e : detection.views)
    stored.evidence.push_back({e.view, e.allowed, e.visible_share, e.explained_share, e.color_share});
  stored.verdict = verdict;
  return stored;
}

}  // namespace

StoredView to_stored_view(const ViewRecord& view, const ModelLibrary& library) {
  const SceneUpdate& update = view.update;
  StoredView stored;
  stored.name = update.view_name;
  stored.world_from_camera = update.world_from_camera;
  for (std::size_t i = 0; i < update.detections.size(); ++i) {
    const Detection& detection = update.detections[i];
    stored.detections.push_back(to_stored_detection(detection, library.object(detection.object),
                                                    view.evaluation ? to_string(view.marks.at(i)) : std::string()));
  }
  stored.num_novel_points = static_cast<int>(view.num_novel_points);
  stored.num_removed_points = static_cast<int>(view.num_removed_points);
  stored.changed_share = update.changes.changed_share;
  stored.pose_suspect = update.changes.pose_suspect;
  return stored;
}

std::vector<StoredEvent> to_stored_events(const ViewRecord& view, const ModelLibrary& library) {
  std::vector<StoredEvent> stored;
  for (const ObjectEvent& event : view.update.events)
    stored.push_back({event.view, to_string(event.kind), library.object(event.object).name, event.track,
                      event.world_from_object_before, event.world_from_object_after, event.confidence});
  return stored;
}

}  // namespace resight
