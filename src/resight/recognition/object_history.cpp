// SPDX-License-Identifier: Apache-2.0
#include "resight/recognition/object_history.hpp"

#include <algorithm>
#include <tuple>
#include <utility>

#include "resight/core/check.hpp"
#include "resight/geometry/symmetry.hpp"

namespace resight {
namespace {

constexpr int kUnmatched = -1;

// What only earlier views saw is no news.
bool is_seen_now(const Detection& detection, double min_share) {
  return detection.views.empty() || detection.views.back().confirmed_share() >= min_share;
}

}  // namespace

void ObjectHistoryOptions::check() const {
  check_positive("ObjectHistoryOptions.same_place_m", same_place_m);
  check_positive("ObjectHistoryOptions.same_rotation_rad", same_rotation_rad);
  check_not_negative("ObjectHistoryOptions.confirm_removal_views", confirm_removal_views);
  check_not_negative("ObjectHistoryOptions.correct_views", correct_views);
  check_in_range("ObjectHistoryOptions.min_new_share", min_new_share, 0, 1);
  check_in_range("ObjectHistoryOptions.min_told_score", min_told_score, 0, 1);
  check_in_range("ObjectHistoryOptions.min_displaced_gone_share", min_displaced_gone_share, 0, 1);
  presence.check();
  memory.check();
}

ObjectHistory::ObjectHistory(const ModelLibrary& library, ObjectHistoryOptions options)
    : library_(library), options_(std::move(options)), memory_(options_.memory), tentative_(library) {
  options_.check();
}

std::vector<ObjectEvent> ObjectHistory::update(int view, std::vector<Detection>& detections, const RgbdFrame& current,
                                               bool use_evidence) {
  std::vector<ObjectEvent> events;
  std::vector<int> track_of(detections.size(), kUnmatched);
  match_in_place(detections, track_of, view, events);
  look_at_old_places(detections, track_of, view, current, use_evidence, events);
  std::vector<std::size_t> tentative;
  for (std::size_t d = 0; d < detections.size(); ++d) {
    if (track_of[d] != kUnmatched) {
      tentative_.take(detections[d], view);  // Two of one kind are not in one place.
    } else if (is_seen_now(detections[d], options_.min_new_share)) {
      if (!is_confirmed(detections[d], view)) {
        tentative.push_back(d);
        continue;
      }
      place_new(detections[d], view, current, use_evidence, events);
      for (std::size_t other = 0; other < detections.size(); ++other)  // What only older views saw at its old place.
        if (other != d && detections[other].track == detections[d].track) detections[other].track = -1;
    }
  }
  for (const std::size_t d : tentative) {
    detections[d].track = tentative_.keep(detections[d], view, next_id_);
    next_id_ = std::max(next_id_, detections[d].track + 1);
  }
  confirm_removals(view, events);
  std::erase_if(tracks_, [](const Track& track) { return track.state == State::kJoined; });
  if (use_evidence) {
    tentative_.forget_gone(view, current, options_.presence);
    memory_.add(view, current);
  }
  tentative_.forget_before(view - options_.memory.max_views);
  std::erase_if(former_placements_,
                [&](const FormerPlacement& placement) { return !memory_.reaches_back_to(placement.seen_view); });
  return events;
}

bool ObjectHistory::is_same_place(const ObjectModel& model, const Rigid3& a, const Rigid3& b) const {
  return center_distance_m(model, a, b) <= options_.same_place_m &&
         symmetric_rotation_distance_rad(a, b, model.symmetries) <= options_.same_rotation_rad;
}

void ObjectHistory::match_in_place(std::vector<Detection>& detections, std::vector<int>& track_of, int view,
                                   std::vector<ObjectEvent>& events) {
  for (std::size_t t = 0; t < tracks_.size(); ++t) {
    Track& track = tracks_[t];
    if (track.state == State::kGone) continue;
    int best = kUnmatched;
    double best_m = 0;
    for (std::size_t d = 0; d < detections.size(); ++d) {
      if (track_of[d] != kUnmatched || track.object != detections[d].object ||
          !is_same_place(model_of(track), detections[d].world_from_object, track.world_from_object))
        continue;
      const double distance_m =
          center_distance_m(model_of(track), track.world_from_object, detections[d].world_from_object);
      if (best != kUnmatched && distance_m >= best_m) continue;
      best = static_cast<int>(d);
      best_m = distance_m;
    }
    if (best == kUnmatched) continue;
    track_of[static_cast<std::size_t>(best)] = static_cast<int>(t);
    keep_in_place(track, detections[static_cast<std::size_t>(best)], view, events);
  }
}

void ObjectHistory::keep_in_place(Track& track, Detection& detection, int view,
                                  std::vector<ObjectEvent>& events) const {
  detection.track = track.id;
  events.push_back({ObjectEventKind::kStillThere, track.object, track.id, view, track.world_from_object,
                    detection.world_from_object, detection.score, std::nullopt});
  track.world_from_object = detection.world_from_object;
  track.last_view = view;
  track.state = State::kPresent;
  if (!is_seen_now(detection, options_.min_new_share)) return;
  track.seen_view = view;
  correct_arrival(track, view, events);
}

// What is first seen in part may be taken to lie a little otherwise than it does.
void ObjectHistory::correct_arrival(Track& track, int view, std::vector<ObjectEvent>& events) const {
  if (!track.arrival || view - track.reported_view > options_.correct_views) return;
  ObjectEvent& arrival = *track.arrival;
  const ObjectModel& model = model_of(track);
  if (is_same_place(model, *arrival.world_from_object_after, track.world_from_object)) return;
  arrival.supersedes = {arrival.kind, track.id, arrival.view};
  const auto& before = arrival.world_from_object_before;
  if (before && is_same_place(model, *before, track.world_from_object)) {  // It has not moved at all.
    events.back().supersedes = arrival.supersedes;
    track.arrival.reset();
    return;
  }
  arrival.view = view;
  arrival.world_from_object_after = track.world_from_object;
  events.push_back(arrival);
}

// Two bodies of one kind cannot overlap: the nearest free detection inside the old place is the same object.
int ObjectHistory::find_displaced(const Track& track, std::span<const Detection> detections,
                                  std::span<const int> track_of) const {
  const ObjectModel& model = model_of(track);
  int nearest = kUnmatched;
  double nearest_m = same_body_distance_m(model);
  for (std::size_t d = 0; d < detections.size(); ++d) {
    if (track_of[d] != kUnmatched || detections[d].object != track.object) continue;
    const double distance_m = center_distance_m(model, track.world_from_object, detections[d].world_from_object);
    if (distance_m >= nearest_m) continue;
    nearest = static_cast<int>(d);
    nearest_m = distance_m;
  }
  return nearest;
}

void ObjectHistory::look_at_old_places(std::vector<Detection>& detections, std::vector<int>& track_of, int view,
                                       const RgbdFrame& current, bool use_evidence, std::vector<ObjectEvent>& events) {
  std::vector<std::size_t> left;
  std::vector<std::pair<std::size_t, bool>> undecided;  // and whether a surface is seen where it was
  std::vector<int> taken = track_of;  // and by tracks that have moved there, which place_new() will see to
  for (std::size_t t = 0; t < tracks_.size(); ++t) {
    Track& track = tracks_[t];
    const bool seen = std::find(track_of.begin(), track_of.end(), static_cast<int>(t)) != track_of.end();
    if (seen || track.state != State::kPresent) continue;
    const ObjectPresence presence =
        use_evidence ? assess_presence(model_of(track).surface, track.world_from_object, current, options_.presence)
                     : ObjectPresence{};
    const int displaced = find_displaced(track, detections, taken);
    if (displaced != kUnmatched) taken[static_cast<std::size_t>(displaced)] = static_cast<int>(t);
    const bool is_free =
        !use_evidence || (presence.is_informative && presence.gone_share >= options_.min_displaced_gone_share);
    const bool has_moved = displaced != kUnmatched && is_free &&
                           is_seen_now(detections[static_cast<std::size_t>(displaced)], options_.min_new_share);
    if (presence.is_gone || has_moved) {
      leave(track, view, has_moved ? 1.0 : presence.gone_share, false);
      if (!has_moved) left.push_back(t);
    } else if (displaced != kUnmatched) {
      track_of[static_cast<std::size_t>(displaced)] = static_cast<int>(t);
      keep_in_place(track, detections[static_cast<std::size_t>(displaced)], view, events);
    } else {
      undecided.emplace_back(t, presence.is_informative && !is_free);
    }
  }
  for (const auto& [t, is_surface_seen] : undecided) {  // Now it is known which others are where they were.
    Track& track = tracks_[t];
    const Detection* taker =
        use_evidence ? find_replacement(track, view, is_surface_seen, detections, track_of) : nullptr;
    if (taker == nullptr) {
      events.push_back({ObjectEventKind::kNotSeen, track.object, track.id, view, track.world_from_object, std::nullopt,
                        0.0, std::nullopt});
      continue;
    }
    leave(track, view, taker->score, true);
    left.push_back(t);
  }
  for (const std::size_t t : left) {
    Track* added = tracks_[t].state == State::kLeaving ? find_added_since(tracks_[t]) : nullptr;
    if (added != nullptr) join(tracks_[t], *added, view, detections, events);
  }
}

void ObjectHistory::leave(Track& track, int view, double confidence, bool is_replaced) {
  track.state = State::kLeaving;
  track.is_replaced = is_replaced;
  track.left_view = view;
  track.confidence = confidence;
}

// Another one that the view shows in its space, and that came there after this one was last seen. Where a surface is
// seen that might be its own, the other one must be of its size: a bowl may stand around it.
const Detection* ObjectHistory::find_replacement(const Track& track, int view, bool is_surface_seen,
                                                 std::span<const Detection> detections,
                                                 std::span<const int> track_of) const {
  for (std::size_t d = 0; d < detections.size(); ++d) {
    const Detection& detection = detections[d];
    if (detection.object == track.object || !is_seen_now(detection, options_.min_new_share)) continue;
    const int other = track_of[d];
    if (other == kUnmatched && !is_confirmed(detection, -1)) continue;
    const int since_view = other == kUnmatched ? tentative_.since_view(detection, view)
                                               : tracks_[static_cast<std::size_t>(other)].since_view;
    if (since_view <= track.seen_view) continue;
    if (is_in_space_of(track, detection) && (!is_surface_seen || is_in_space_of(detection, track))) return &detection;
  }
  return nullptr;
}

// The last view that showed another one in its space; nothing if none did.
std::optional<int> ObjectHistory::last_seen_taken(const Detection& detection, int view) const {
  std::optional<int> last;
  const auto look_at = [&](const FormerPlacement& placement) {
    if (placement.object != detection.object && placement.seen_view > last.value_or(-1) && placement.seen_view < view &&
        memory_.reaches_back_to(placement.seen_view) && is_in_space_of(detection, placement))
      last = placement.seen_view;
  };
  std::ranges::for_each(former_placements_, look_at);
  for (const Track& track : tracks_) look_at({track.object, track.world_from_object, track.seen_view});
  return last;
}

// The nearest one of its kind that was added after a view last saw this one.
ObjectHistory::Track* ObjectHistory::find_added_since(const Track& left) {
  const ObjectModel& model = model_of(left);
  Track* nearest = nullptr;
  double nearest_m = 0;
  for (Track& track : tracks_) {
    const bool is_there = track.state == State::kPresent || track.state == State::kLeaving;
    if (track.object != left.object || !is_there || !was_added(track) || track.since_view <= left.seen_view) continue;
    const double distance_m = center_distance_m(model, track.world_from_object, left.world_from_object);
    if (nearest != nullptr && distance_m >= nearest_m) continue;
    nearest = &track;
    nearest_m = distance_m;
  }
  return nearest;
}

// What left its place is what was added elsewhere: one track, the older one, and one event.
void ObjectHistory::join(Track& left, Track& added, int view, std::vector<Detection>& detections,
                         std::vector<ObjectEvent>& events) {
  // What this view has told of it is not told; if it corrected the arrival, then the arrival as it was told before.
  const ObjectEvent& arrival = *added.arrival;
  const ReplacedEvent replaced = arrival.view == view && arrival.supersedes
                                     ? *arrival.supersedes
                                     : ReplacedEvent{ObjectEventKind::kAdded, added.id, arrival.view};
  std::erase_if(events, [&](const ObjectEvent& e) { return e.track == added.id; });
  for (Detection& d : detections)
    if (d.track == added.id) d.track = left.id;
  events.push_back({ObjectEventKind::kMoved, left.object, left.id, view, left.world_from_object,
                    added.world_from_object, left.confidence, replaced});
  former_placements_.push_back({left.object, left.world_from_object, left.seen_view});
  left = [&] {
    Track joined = added;
    joined.id = left.id;
    joined.arrival = events.back();
    return joined;
  }();
  added.state = State::kJoined;
}

// The nearest old place of this kind of object that is seen free, and one that it can have come from right away, which
// it cannot if its new place was seen free as well since then; one that is leaving goes before one long gone.
ObjectHistory::Track* ObjectHistory::find_left(const Detection& detection, int since_view,
                                               std::optional<int> last_free_view) {
  const ObjectModel& model = model_of(detection);
  Track* left = nullptr;
  for (Track& track : tracks_) {
    if (track.object != detection.object || (track.state != State::kLeaving && track.state != State::kGone)) continue;
    if (track.seen_view >= since_view) continue;  // Elsewhere, when this one was here.
    const auto rank = [&](const Track& t) {
      return std::tuple(last_free_view && *last_free_view >= t.left_view, t.state == State::kGone,
                        center_distance_m(model, t.world_from_object, detection.world_from_object));
    };
    if (left == nullptr || rank(track) < rank(*left)) left = &track;
  }
  return left;
}

// The only known object of this kind that the view does not show, if it does not see its place: what is new elsewhere
// is likely that one.
ObjectHistory::Track* ObjectHistory::find_out_of_sight(const Detection& detection, int since_view,
                                                       const RgbdFrame& current) {
  Track* only = nullptr;
  for (Track& track : tracks_) {
    if (track.object != detection.object || track.state != State::kPresent || track.seen_view >= since_view) continue;
    if (only != nullptr) return nullptr;
    only = &track;
  }
  if (only == nullptr) return nullptr;
  const ObjectModel& model = model_of(*only);
  const ObjectPresence presence = assess_presence(model.surface, only->world_from_object, current, options_.presence);
  const bool is_there = presence.is_informative && presence.gone_share < options_.min_displaced_gone_share;
  return is_there ? nullptr : only;
}

ObjectHistory::Track& ObjectHistory::new_track(int object, int id) {
  Track track;
  track.id = id;
  track.object = object;
  return tracks_.emplace_back(track);
}

// What may well be something else is not told before a view is sure of it; what lies in the old place of one that has
// just left it is that one.
bool ObjectHistory::is_confirmed(const Detection& detection, int view) const {
  return detection.score >= options_.min_told_score || std::ranges::any_of(tracks_, [&](const Track& track) {
           const ObjectModel& model = model_of(track);
           return track.object == detection.object && track.state == State::kLeaving && track.left_view == view &&
                  center_distance_m(model, track.world_from_object, detection.world_from_object) <
                      same_body_distance_m(model);
         });
}

void ObjectHistory::place_new(Detection& detection, int view, const RgbdFrame& current, bool use_evidence,
                              std::vector<ObjectEvent>& events) {
  constexpr double kOutOfSightConfidence = 0.5;
  const PointCloud& surface = model_of(detection).surface;
  const std::optional<TrackedObject> tentative = tentative_.take(detection, view);
  const int since_view = tentative ? tentative->since_view : view;
  std::optional<int> last_free_view;  // of this object: with nothing there, or another one
  if (use_evidence)
    last_free_view = std::max(memory_.last_seen_free(surface, detection.world_from_object, options_.presence),
                              last_seen_taken(detection, view));
  ObjectEvent event{last_free_view ? ObjectEventKind::kAdded : ObjectEventKind::kFound,
                    detection.object,
                    -1,
                    view,
                    std::nullopt,
                    detection.world_from_object,
                    detection.score,
                    std::nullopt};
  const auto report_move = [&](const Track& from, double confidence) {
    event.kind = ObjectEventKind::kMoved;
    event.world_from_object_before = from.world_from_object;
    event.confidence = std::min(confidence, detection.score);
  };
  Track* from = find_left(detection, since_view, last_free_view);
  const bool was_away = from != nullptr && last_free_view && *last_free_view >= from->left_view;
  // Whether the new place was free since a time that is forgotten nobody knows.
  const bool is_recent =
      from != nullptr && (from->state == State::kLeaving || memory_.reaches_back_to(from->left_view));
  if (from != nullptr && is_recent && !was_away) {
    report_move(*from, from->confidence);
    if (from->state == State::kGone) event.supersedes = {ObjectEventKind::kRemoved, from->id, from->left_view};
  } else if (Track* hidden = last_free_view ? find_out_of_sight(detection, since_view, current) : nullptr;
             hidden != nullptr) {
    report_move(*hidden, kOutOfSightConfidence);
    std::erase_if(events, [&](const ObjectEvent& e) { return e.track == hidden->id && !is_change(e.kind); });
    from = hidden;
  } else if (from != nullptr && from->state == State::kLeaving) {
    remove(*from, events);  // It was away before it was put here.
  }
  if (from == nullptr)
    from = &new_track(detection.object, tentative ? tentative->track : next_id_++);
  else
    former_placements_.push_back({from->object, from->world_from_object, from->seen_view});
  event.track = from->id;
  events.push_back(event);
  from->world_from_object = detection.world_from_object;
  from->last_view = from->seen_view = from->reported_view = view;
  from->since_view = since_view;
  if (is_change(event.kind))
    from->arrival = event;
  else
    from->arrival.reset();
  from->state = State::kPresent;
  detection.track = from->id;
}

void ObjectHistory::remove(Track& track, std::vector<ObjectEvent>& events) const {
  track.state = State::kGone;
  events.push_back({ObjectEventKind::kRemoved, track.object, track.id, track.left_view, track.world_from_object,
                    std::nullopt, track.confidence, std::nullopt});
}

void ObjectHistory::confirm_removals(int view, std::vector<ObjectEvent>& events) {
  for (Track& track : tracks_) {
    if (track.state != State::kLeaving || view - track.left_view < options_.confirm_removal_views) continue;
    if (track.is_replaced && !is_still_taken(track, view))
      track.state = State::kPresent;  // The other one was seen once only: perhaps it was this one.
    else
      remove(track, events);
  }
}

bool ObjectHistory::is_still_taken(const Track& left, int view) const {
  return std::ranges::any_of(tracks_, [&](const Track& track) {
    return track.object != left.object && track.state == State::kPresent && track.seen_view == view &&
           is_in_space_of(left, track);
  });
}

std::vector<TrackedObject> ObjectHistory::tracked_objects() const {
  std::vector<TrackedObject> known;
  for (const Track& track : tracks_)
    if (track.state == State::kPresent)
      known.push_back(
          {track.id, track.object, track.world_from_object, track.last_view, track.seen_view, track.since_view});
  known.insert(known.end(), tentative_.objects().begin(), tentative_.objects().end());
  return known;
}

std::vector<ObjectEvent> ObjectHistory::finish() {
  std::vector<ObjectEvent> events;
  for (Track& track : tracks_)
    if (track.state == State::kLeaving) remove(track, events);
  return events;
}

}  // namespace resight
