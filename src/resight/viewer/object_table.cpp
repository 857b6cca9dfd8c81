// SPDX-License-Identifier: Apache-2.0
#include "resight/viewer/object_table.hpp"

namespace resight {

ObjectTable::ObjectTable(const ViewerScene& scene) {
  if (scene.library) {
    for (const ObjectModel& model : scene.library->objects) add(model.name, model.bop_id);
  } else {
    for (const ModelLocation& model : scene.models) add(model.name, model.bop_id);
  }
  for (const ViewerRun& run : scene.runs) {
    for (const StoredView& view : run.results.views)
      for (const StoredDetection& detection : view.detections) add(detection.object, detection.bop_id);
    for (const StoredEvent& event : run.results.events) add(event.object, 0);
  }
}

int ObjectTable::add(const std::string& name, int bop_id) {
  const auto [place, is_new] = numbers_.emplace(name, static_cast<int>(objects_.size()));
  if (is_new) objects_.push_back({name, bop_id});
  return place->second;
}

int ObjectTable::find(const std::string& name) const {
  const auto found = numbers_.find(name);
  return found == numbers_.end() ? -1 : found->second;
}

}  // namespace resight
