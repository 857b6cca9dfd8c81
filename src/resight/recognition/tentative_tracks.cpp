// SPDX-License-Identifier: Apache-2.0
#include "resight/recognition/tentative_tracks.hpp"

#include "resight/recognition/body_overlap.hpp"

namespace resight {

// The nearest one of its kind whose body overlaps that of the detection, or the number of objects.
std::size_t TentativeTracks::find(const Detection& detection, int before_view) const {
  const ObjectModel& model = library_.objects[static_cast<std::size_t>(detection.object)];
  std::size_t nearest = objects_.size();
  double nearest_m = same_body_distance_m(model);
  for (std::size_t i = 0; i < objects_.size(); ++i) {
    const TrackedObject& known = objects_[i];
    if (known.object != detection.object || known.last_view >= before_view) continue;
    const double distance_m = center_distance_m(model, known.world_from_object, detection.world_from_object);
    if (distance_m >= nearest_m ||
        !is_mostly_within(model, detection.world_from_object, model, known.world_from_object))
      continue;
    nearest = i;
    nearest_m = distance_m;
  }
  return nearest;
}

int TentativeTracks::keep(const Detection& detection, int view, int new_id) {
  const std::size_t i = find(detection, view);
  if (i == objects_.size()) {
    TrackedObject& added = objects_.emplace_back();
    added.track = new_id;
    added.object = detection.object;
    added.since_view = view;
    added.is_confirmed = false;
  }
  TrackedObject& known = objects_[i];
  known.world_from_object = detection.world_from_object;
  known.last_view = known.seen_view = view;
  return known.track;
}

std::optional<TrackedObject> TentativeTracks::take(const Detection& detection, int view) {
  const std::size_t i = find(detection, view);
  if (i == objects_.size()) return std::nullopt;
  const TrackedObject taken = objects_[i];
  objects_.erase(objects_.begin() + static_cast<std::ptrdiff_t>(i));
  return taken;
}

int TentativeTracks::since_view(const Detection& detection, int view) const {
  const std::size_t i = find(detection, view);
  return i == objects_.size() ? view : objects_[i].since_view;
}

void TentativeTracks::forget_before(int view) {
  std::erase_if(objects_, [&](const TrackedObject& known) { return known.last_view < view; });
}

void TentativeTracks::forget_gone(int view, const RgbdFrame& frame, const PresenceOptions& options) {
  std::erase_if(objects_, [&](const TrackedObject& known) {
    const PointCloud& surface = library_.objects[static_cast<std::size_t>(known.object)].surface;
    return known.last_view != view && assess_presence(surface, known.world_from_object, frame, options).is_gone;
  });
}

}  // namespace resight
