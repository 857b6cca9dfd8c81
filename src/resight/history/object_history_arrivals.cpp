// SPDX-License-Identifier: Apache-2.0
// ObjectHistory: objects at new places, and corrections of their first poses.
#include <algorithm>
#include <optional>

#include "resight/history/object_history.hpp"

namespace resight {
namespace {

// An arrival whose pose is corrected is reported again, up to this many views after its first report.
constexpr int kCorrectViews = 6;

}  // namespace

void ObjectHistory::add_unmatched_observations(View& view) {
  std::vector<std::size_t> tentative;
  for (std::size_t i = 0; i < view.observations.size(); ++i) {
    const ObjectObservation& observed = view.observations[i];
    if (view.track_of[i] != kUnmatched)
      tentative_.promote(observed, view.view);  // A place holds one object of a kind.
    else if (is_confirmed_by_view(observed) && !is_confirmed(observed, view.view))
      tentative.push_back(i);
    else if (is_confirmed_by_view(observed))
      place_new(i, view);
  }
  for (const std::size_t i : tentative) {
    const int track = tentative_.update(view.observations[i], view.view, next_id_);
    view.update.tracks[i] = track;
    next_id_ = std::max(next_id_, track + 1);
  }
}

// Confirmed by its score, or because it lies in the old place of an object of its kind that has just left it.
bool ObjectHistory::is_confirmed(const ObjectObservation& observed, int view) const {
  return observed.score >= options_.confirm_score || association_.has_just_left(observed, view, tracks_);
}

// The only object of this kind that the view does not show, unless the view sees it at its place: an object that is new
// elsewhere is probably that one.
Track* ObjectHistory::find_out_of_sight(const ObjectObservation& observed, int since_view, const RgbdFrame& frame) {
  Track* only = association_.find_only_unseen(observed, since_view, tracks_);
  if (only == nullptr) return nullptr;
  const ObjectPresence presence =
      assess_presence(association_.model_of(only->object).surface, only->world_from_object, frame, options_.presence);
  const bool is_there = presence.is_informative && presence.gone_share < kMinDisplacedGoneShare;
  return is_there ? nullptr : only;
}

void ObjectHistory::place_new(std::size_t observation, View& view) {
  const ObjectObservation& observed = view.observations[observation];
  const std::optional<TrackedObject> tentative = tentative_.promote(observed, view.view);
  const int since_view = tentative ? tentative->since_view : view.view;
  std::optional<int> last_free_view;  // Free of this object: the place was empty, or another object was in it.
  if (view.use_evidence) {
    const bool has_come = view.find_change && view.find_change(observed.object, observed.world_from_object,
                                                               view.view) == PlaceChange::kCame;
    last_free_view = memory_.last_free_view(observed, view.view, tracks_,
                                            has_come ? without_base(options_.presence) : options_.presence);
  }
  ObjectEvent event{last_free_view ? ObjectEventKind::kAdded : ObjectEventKind::kFound,
                    observed.object,
                    -1,
                    view.view,
                    std::nullopt,
                    observed.world_from_object,
                    observed.score,
                    std::nullopt};
  Track* track = find_previous_track(observed, since_view, last_free_view, view, event);
  if (track == nullptr)
    track = &new_track(observed.object, tentative ? tentative->track : next_id_++);
  else
    memory_.add_former_placement(*track);
  event.track = track->id;
  view.update.events.push_back(event);
  track->world_from_object = observed.world_from_object;
  track->last_view = track->seen_view = track->reported_view = view.view;
  track->since_view = since_view;
  track->arrival = is_change(event.kind) ? std::optional(event) : std::nullopt;
  track->state = TrackState::kPresent;
  std::ranges::replace(view.update.tracks, track->id, -1);  // Only older views show it at its old place.
  view.update.tracks[observation] = track->id;
}

// The track that an object at a new place continues, or null. Makes the event a move where the object comes from the
// place of that track.
Track* ObjectHistory::find_previous_track(const ObjectObservation& observed, int since_view,
                                          std::optional<int> last_free_view, View& view, ObjectEvent& event) {
  constexpr double kOutOfSightConfidence = 0.5;  // No view has seen the former place free.
  const auto report_move = [&](const Track& from, double confidence) {
    event.kind = ObjectEventKind::kMoved;
    event.world_from_object_before = from.world_from_object;
    event.confidence = std::min(confidence, observed.score);
  };
  Track* left = association_.find_left(observed, since_view, last_free_view, tracks_);
  const bool was_away = left != nullptr && last_free_view && *last_free_view >= left->left_view;
  // Beyond the memory, nobody knows whether the new place was free since the object left.
  const bool is_recent =
      left != nullptr && (left->state == TrackState::kLeaving || memory_.reaches_back_to(left->left_view));
  if (is_recent && !was_away) {
    report_move(*left, left->confidence);
    if (left->state == TrackState::kGone) event.supersedes = {ObjectEventKind::kRemoved, left->id, left->left_view};
    return left;
  }
  if (Track* hidden = last_free_view ? find_out_of_sight(observed, since_view, view.frame) : nullptr) {
    report_move(*hidden, kOutOfSightConfidence);
    std::erase_if(view.update.events,
                  [&](const ObjectEvent& e) { return e.track == hidden->id && !is_change(e.kind); });
    return hidden;
  }
  if (left != nullptr && left->state == TrackState::kLeaving) remove(*left, view.update.events);  // It was away first.
  return left;
}

Track& ObjectHistory::new_track(int object, int id) {
  Track& track = tracks_.emplace_back();
  track.id = id;
  track.object = object;
  return track;
}

// The first pose of an object that was seen in part only may be off.
void ObjectHistory::correct_arrival(Track& track, View& view) const {
  if (!track.arrival || view.view - track.reported_view > kCorrectViews) return;
  ObjectEvent& arrival = *track.arrival;
  std::vector<ObjectEvent>& events = view.update.events;
  if (association_.is_same_place(track.object, *arrival.world_from_object_after, track.world_from_object)) return;
  arrival.supersedes = {arrival.kind, track.id, arrival.view};
  const auto& before = arrival.world_from_object_before;
  if (before && association_.is_same_place(track.object, *before, track.world_from_object)) {  // It has not moved.
    events.back().supersedes = arrival.supersedes;
    track.arrival.reset();
    return;
  }
  arrival.view = view.view;
  arrival.world_from_object_after = track.world_from_object;
  events.push_back(arrival);
}

}  // namespace resight
