// SPDX-License-Identifier: Apache-2.0
#include "resight/history/object_history.hpp"

#include <algorithm>
#include <optional>
#include <utility>

namespace resight {
namespace {

// A removal is reported if the object is not recognised elsewhere for this many views after its place was seen free.
constexpr int kConfirmRemovalViews = 1;

}  // namespace

ObjectHistory::ObjectHistory(const ModelLibrary& library, const ObjectHistoryOptions& options)
    : options_((options.check(), options)),
      association_(library, options_.same_place_m, kSameTrackRotation_rad),
      memory_(library, options_.memory),
      tentative_(library) {}

HistoryUpdate ObjectHistory::update(int number, std::span<const ObjectObservation> observations, const RgbdFrame& frame,
                                    bool use_evidence, const FindPlaceChange& find_change) {
  HistoryUpdate update{{}, std::vector<int>(observations.size(), -1)};
  View view{{number, observations, std::vector<int>(observations.size(), kUnmatched)},
            frame,
            use_evidence,
            find_change,
            update};
  match_in_place(view);
  update_unmatched_tracks(view);
  add_unmatched_observations(view);
  confirm_removals(view);
  forget_old(view);
  return update;
}

std::vector<ObjectEvent> ObjectHistory::finish() {
  std::vector<ObjectEvent> events;
  for (Track& track : tracks_)
    if (track.state == TrackState::kLeaving) remove(track, events);
  return events;
}

std::vector<TrackedObject> ObjectHistory::tracked_objects() const {
  std::vector<TrackedObject> tracked;
  for (const Track& track : tracks_)
    if (track.state == TrackState::kPresent)
      tracked.push_back(
          {track.id, track.object, track.world_from_object, track.last_view, track.seen_view, track.since_view});
  tracked.insert(tracked.end(), tentative_.objects().begin(), tentative_.objects().end());
  return tracked;
}

void ObjectHistory::match_in_place(View& view) {
  for (std::size_t t = 0; t < tracks_.size(); ++t) {
    if (tracks_[t].state == TrackState::kGone) continue;
    const int nearest = association_.find_in_place(tracks_[t], view);
    if (nearest == kUnmatched) continue;
    view.track_of[static_cast<std::size_t>(nearest)] = static_cast<int>(t);
    keep_in_place(tracks_[t], nearest, view);
  }
}

void ObjectHistory::keep_in_place(Track& track, int observation, View& view) const {
  const ObjectObservation& observed = view.observations[static_cast<std::size_t>(observation)];
  view.update.tracks[static_cast<std::size_t>(observation)] = track.id;
  view.update.events.push_back({ObjectEventKind::kStillThere, track.object, track.id, view.view,
                                track.world_from_object, observed.world_from_object, observed.score, std::nullopt});
  track.world_from_object = observed.world_from_object;
  track.last_view = view.view;
  track.state = TrackState::kPresent;
  if (!is_confirmed_by_view(observed)) return;
  track.seen_view = view.view;
  correct_arrival(track, view);
}

// Decides for each present track without an observation at its place whether it has left, is displaced, or is not seen.
void ObjectHistory::update_unmatched_tracks(View& view) {
  std::vector<std::size_t> left;
  std::vector<std::pair<std::size_t, bool>> undecided;  // With: a surface is seen at its place.
  ViewObservations free = view;  // Without the observations of tracks that have moved there; place_new() takes those.
  for (std::size_t t = 0; t < tracks_.size(); ++t) {
    Track& track = tracks_[t];
    const bool is_matched = std::ranges::find(view.track_of, static_cast<int>(t)) != view.track_of.end();
    if (is_matched || track.state != TrackState::kPresent) continue;
    const ObjectPresence presence = assess(track, view);
    const int displaced = association_.find_displaced(track, free);
    if (displaced != kUnmatched) free.track_of[static_cast<std::size_t>(displaced)] = static_cast<int>(t);
    const bool is_free =
        !view.use_evidence || (presence.is_informative && presence.gone_share >= kMinDisplacedGoneShare);
    const bool has_moved = displaced != kUnmatched && is_free &&
                           is_confirmed_by_view(view.observations[static_cast<std::size_t>(displaced)]);
    if (presence.is_gone || has_moved) {
      leave(track, view.view, has_moved ? 1.0 : presence.gone_share, false);
      if (!has_moved) left.push_back(t);
    } else if (displaced != kUnmatched) {
      view.track_of[static_cast<std::size_t>(displaced)] = static_cast<int>(t);
      keep_in_place(track, displaced, view);
    } else {
      undecided.emplace_back(t, presence.is_informative && !is_free);
    }
  }
  for (const auto& [t, is_surface_seen] : undecided) {  // Now all other tracks at their places are known.
    Track& track = tracks_[t];
    const ObjectObservation* other = view.use_evidence ? find_replacement(track, is_surface_seen, view) : nullptr;
    if (other == nullptr) {
      view.update.events.push_back({ObjectEventKind::kNotSeen, track.object, track.id, view.view,
                                    track.world_from_object, std::nullopt, 0.0, std::nullopt});
      continue;
    }
    leave(track, view.view, other->score, true);
    left.push_back(t);
  }
  for (const std::size_t t : left) {
    if (tracks_[t].state != TrackState::kLeaving) continue;
    if (Track* added = association_.find_added_since(tracks_[t], tracks_)) join(tracks_[t], *added, view);
  }
}

// What is behind a flat object may be within the margin of its depth, which allows for errors of its pose. If surface
// was removed there, only the noise counts.
ObjectPresence ObjectHistory::assess(const Track& track, const View& view) const {
  if (!view.use_evidence) return {};
  const auto assess_with = [&](const PresenceOptions& options) {
    return assess_presence(association_.model_of(track.object).surface, track.world_from_object, view.frame, options);
  };
  const ObjectPresence presence = assess_with(options_.presence);
  if (presence.is_gone || !view.find_change ||
      view.find_change(track.object, track.world_from_object, track.seen_view) != PlaceChange::kLeft)
    return presence;
  const ObjectPresence without_margin = assess_with(without_base(options_.presence));
  return without_margin.is_gone ? without_margin : presence;
}

// Another object that the view shows in the space of the track, and that came there after the track was last seen.
// Where a surface is seen that might be the track's own, the other object must be of its size: a bowl may stand around
// it.
const ObjectObservation* ObjectHistory::find_replacement(const Track& track, bool is_surface_seen,
                                                         const View& view) const {
  for (std::size_t i = 0; i < view.observations.size(); ++i) {
    const ObjectObservation& observed = view.observations[i];
    if (observed.object == track.object || !is_confirmed_by_view(observed)) continue;
    const int other = view.track_of[i];
    if (other == kUnmatched && !is_confirmed(observed, -1)) continue;
    const int since_view = other == kUnmatched ? tentative_.since_view(observed, view.view)
                                               : tracks_[static_cast<std::size_t>(other)].since_view;
    if (since_view <= track.seen_view) continue;
    if (association_.is_in_space_of(track, observed) &&
        (!is_surface_seen || association_.is_in_space_of(observed, track)))
      return &observed;
  }
  return nullptr;
}

void ObjectHistory::leave(Track& track, int view, double confidence, bool is_replaced) {
  track.state = TrackState::kLeaving;
  track.is_replaced = is_replaced;
  track.left_view = view;
  track.confidence = confidence;
}

// The object that left its place is the one that was added elsewhere: the older track continues, with one event.
void ObjectHistory::join(Track& left, Track& added, View& view) {
  // The move replaces the events of this view; if one of them corrected the arrival, the move supersedes the arrival as
  // it was reported before.
  const ObjectEvent& arrival = *added.arrival;
  const SupersededEvent superseded = arrival.view == view.view && arrival.supersedes
                                         ? *arrival.supersedes
                                         : SupersededEvent{ObjectEventKind::kAdded, added.id, arrival.view};
  std::vector<ObjectEvent>& events = view.update.events;
  std::erase_if(events, [&](const ObjectEvent& e) { return e.track == added.id; });
  std::ranges::replace(view.update.tracks, added.id, left.id);
  events.push_back({ObjectEventKind::kMoved, left.object, left.id, view.view, left.world_from_object,
                    added.world_from_object, left.confidence, superseded});
  memory_.add_former_placement(left);
  const int id = left.id;
  left = added;
  left.id = id;
  left.arrival = events.back();
  added.state = TrackState::kJoined;
}

void ObjectHistory::confirm_removals(View& view) {
  for (Track& track : tracks_) {
    if (track.state != TrackState::kLeaving || view.view - track.left_view < kConfirmRemovalViews) continue;
    if (track.is_replaced && !association_.is_still_occupied(track, view.view, tracks_))
      track.state = TrackState::kPresent;  // The other object was seen only once: it may have been this one.
    else
      remove(track, view.update.events);
  }
}

void ObjectHistory::remove(Track& track, std::vector<ObjectEvent>& events) {
  track.state = TrackState::kGone;
  events.push_back({ObjectEventKind::kRemoved, track.object, track.id, track.left_view, track.world_from_object,
                    std::nullopt, track.confidence, std::nullopt});
}

void ObjectHistory::forget_old(const View& view) {
  std::erase_if(tracks_, [](const Track& track) { return track.state == TrackState::kJoined; });
  if (view.use_evidence) {
    tentative_.forget_gone(view.view, view.frame, options_.presence);
    memory_.add_view(view.view, view.frame);
  }
  tentative_.forget_before(view.view - options_.memory.max_views);
  memory_.forget_old_placements();
}

}  // namespace resight
