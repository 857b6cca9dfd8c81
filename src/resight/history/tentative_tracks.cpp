// SPDX-License-Identifier: Apache-2.0
#include "resight/history/tentative_tracks.hpp"

#include "resight/history/body_overlap.hpp"
#include "resight/models/pose_distance.hpp"

namespace resight {

// Index of the nearest track of this kind whose body overlaps the observed one, or the number of tracks.
std::size_t TentativeTracks::find(const ObjectObservation& observed, int before_view) const {
  const ObjectModel& model = library_.objects[static_cast<std::size_t>(observed.object)];
  std::size_t nearest = objects_.size();
  double nearest_m = same_body_distance_m(model);
  for (std::size_t i = 0; i < objects_.size(); ++i) {
    const TrackedObject& track = objects_[i];
    if (track.object != observed.object || track.last_view >= before_view) continue;
    const double distance_m = center_distance_m(model, track.world_from_object, observed.world_from_object);
    if (distance_m >= nearest_m || !is_mostly_within(model, observed.world_from_object, model, track.world_from_object))
      continue;
    nearest = i;
    nearest_m = distance_m;
  }
  return nearest;
}

int TentativeTracks::update(const ObjectObservation& observed, int view, int new_id) {
  const std::size_t i = find(observed, view);
  if (i == objects_.size()) {
    TrackedObject& added = objects_.emplace_back();
    added.track = new_id;
    added.object = observed.object;
    added.since_view = view;
    added.is_confirmed = false;
  }
  TrackedObject& track = objects_[i];
  track.world_from_object = observed.world_from_object;
  track.last_view = track.seen_view = view;
  return track.track;
}

std::optional<TrackedObject> TentativeTracks::promote(const ObjectObservation& observed, int view) {
  const std::size_t i = find(observed, view);
  if (i == objects_.size()) return std::nullopt;
  const TrackedObject promoted = objects_[i];
  objects_.erase(objects_.begin() + static_cast<std::ptrdiff_t>(i));
  return promoted;
}

int TentativeTracks::since_view(const ObjectObservation& observed, int view) const {
  const std::size_t i = find(observed, view);
  return i == objects_.size() ? view : objects_[i].since_view;
}

void TentativeTracks::forget_before(int view) {
  std::erase_if(objects_, [&](const TrackedObject& track) { return track.last_view < view; });
}

void TentativeTracks::forget_gone(int view, const RgbdFrame& frame, const PresenceOptions& options) {
  std::erase_if(objects_, [&](const TrackedObject& track) {
    const PointCloud& surface = library_.objects[static_cast<std::size_t>(track.object)].surface;
    return track.last_view != view && assess_presence(surface, track.world_from_object, frame, options).is_gone;
  });
}

}  // namespace resight
