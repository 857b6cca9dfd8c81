// SPDX-License-Identifier: Apache-2.0
#include "resight/recognition/unsure_objects.hpp"

#include "resight/recognition/shared_space.hpp"

namespace resight {

std::vector<KnownObject>::iterator UnsureObjects::find(const Detection& detection, int before_view) {
  const ObjectModel& model = library_.objects[static_cast<std::size_t>(detection.object)];
  auto nearest = objects_.end();
  double nearest_m = same_body_distance_m(model);
  for (auto known = objects_.begin(); known != objects_.end(); ++known) {
    if (known->object != detection.object || known->last_view >= before_view) continue;
    const double distance_m = center_distance_m(model, known->world_from_object, detection.world_from_object);
    if (distance_m >= nearest_m) continue;
    nearest = known;
    nearest_m = distance_m;
  }
  return nearest;
}

int UnsureObjects::keep(const Detection& detection, int view, int new_id) {
  auto known = find(detection, view);
  if (known == objects_.end()) {
    known = objects_.emplace(objects_.end());
    known->track = new_id;
    known->object = detection.object;
    known->since_view = view;
    known->is_sure = false;
  }
  known->world_from_object = detection.world_from_object;
  known->last_view = known->seen_view = view;
  return known->track;
}

std::optional<KnownObject> UnsureObjects::take(const Detection& detection, int view) {
  const auto known = find(detection, view);
  if (known == objects_.end()) return std::nullopt;
  const KnownObject taken = *known;
  objects_.erase(known);
  return taken;
}

void UnsureObjects::forget_before(int view) {
  std::erase_if(objects_, [&](const KnownObject& known) { return known.last_view < view; });
}

void UnsureObjects::forget_gone(int view, const RgbdFrame& frame, const PresenceOptions& options) {
  std::erase_if(objects_, [&](const KnownObject& known) {
    const PointCloud& surface = library_.objects[static_cast<std::size_t>(known.object)].surface;
    return known.last_view != view && assess_presence(surface, known.world_from_object, frame, options).is_gone;
  });
}

}  // namespace resight
