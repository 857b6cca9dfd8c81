// SPDX-License-Identifier: Apache-2.0
#include "resight/history/track_association.hpp"

#include <algorithm>
#include <tuple>

#include "resight/history/body_overlap.hpp"
#include "resight/models/pose_distance.hpp"

namespace resight {

bool TrackAssociation::is_same_place(int object, const Rigid3& a, const Rigid3& b) const {
  const ObjectModel& model = model_of(object);
  return resight::is_same_place(model, a, b, {same_place_m_, same_rotation_rad_});
}

bool TrackAssociation::is_within(int one, const Rigid3& world_from_one, int other,
                                 const Rigid3& world_from_other) const {
  return is_mostly_within(model_of(one), world_from_one, model_of(other), world_from_other);
}

int TrackAssociation::find_in_place(const Track& track, const ViewObservations& view) const {
  int nearest = kUnmatched;
  double nearest_m = 0;
  for (std::size_t i = 0; i < view.observations.size(); ++i) {
    const ObjectObservation& observed = view.observations[i];
    if (view.track_of[i] != kUnmatched || track.object != observed.object ||
        !is_same_place(track.object, observed.world_from_object, track.world_from_object))
      continue;
    const double distance_m =
        center_distance_m(model_of(track.object), track.world_from_object, observed.world_from_object);
    if (nearest != kUnmatched && distance_m >= nearest_m) continue;
    nearest = static_cast<int>(i);
    nearest_m = distance_m;
  }
  return nearest;
}

int TrackAssociation::find_displaced(const Track& track, const ViewObservations& view) const {
  const ObjectModel& model = model_of(track.object);
  int nearest = kUnmatched;
  double nearest_m = same_body_distance_m(model);
  for (std::size_t i = 0; i < view.observations.size(); ++i) {
    const ObjectObservation& observed = view.observations[i];
    if (view.track_of[i] != kUnmatched || observed.object != track.object) continue;
    const double distance_m = center_distance_m(model, track.world_from_object, observed.world_from_object);
    if (distance_m >= nearest_m) continue;
    nearest = static_cast<int>(i);
    nearest_m = distance_m;
  }
  return nearest;
}

Track* TrackAssociation::find_added_since(const Track& left, std::span<Track> tracks) const {
  const ObjectModel& model = model_of(left.object);
  Track* nearest = nullptr;
  double nearest_m = 0;
  for (Track& track : tracks) {
    const bool is_there = track.state == TrackState::kPresent || track.state == TrackState::kLeaving;
    if (track.object != left.object || !is_there || !track.was_added() || track.since_view <= left.seen_view) continue;
    const double distance_m = center_distance_m(model, track.world_from_object, left.world_from_object);
    if (nearest != nullptr && distance_m >= nearest_m) continue;
    nearest = &track;
    nearest_m = distance_m;
  }
  return nearest;
}

Track* TrackAssociation::find_left(const ObjectObservation& observed, int since_view, std::optional<int> last_free_view,
                                   std::span<Track> tracks) const {
  const ObjectModel& model = model_of(observed.object);
  const auto rank = [&](const Track& t) {
    return std::tuple(last_free_view && *last_free_view >= t.left_view, t.state == TrackState::kGone,
                      center_distance_m(model, t.world_from_object, observed.world_from_object));
  };
  Track* left = nullptr;
  for (Track& track : tracks) {
    if (track.object != observed.object || (track.state != TrackState::kLeaving && track.state != TrackState::kGone))
      continue;
    if (track.seen_view >= since_view) continue;  // It was elsewhere while this one was here.
    if (left == nullptr || rank(track) < rank(*left)) left = &track;
  }
  return left;
}

Track* TrackAssociation::find_only_unseen(const ObjectObservation& observed, int since_view,
                                          std::span<Track> tracks) const {
  Track* only = nullptr;
  for (Track& track : tracks) {
    if (track.object != observed.object || track.state != TrackState::kPresent || track.seen_view >= since_view)
      continue;
    if (only != nullptr) return nullptr;
    only = &track;
  }
  return only;
}

bool TrackAssociation::has_just_left(const ObjectObservation& observed, int view, std::span<const Track> tracks) const {
  return std::ranges::any_of(tracks, [&](const Track& track) {
    const ObjectModel& model = model_of(track.object);
    return track.object == observed.object && track.state == TrackState::kLeaving && track.left_view == view &&
           center_distance_m(model, track.world_from_object, observed.world_from_object) < same_body_distance_m(model);
  });
}

bool TrackAssociation::is_still_occupied(const Track& left, int view, std::span<const Track> tracks) const {
  return std::ranges::any_of(tracks, [&](const Track& track) {
    return track.object != left.object && track.state == TrackState::kPresent && track.seen_view == view &&
           is_in_space_of(left, track);
  });
}

}  // namespace resight
