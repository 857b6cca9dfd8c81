// SPDX-License-Identifier: Apache-2.0
#include "resight/annotation/annotated_events.hpp"

#include <algorithm>
#include <tuple>

namespace resight {
namespace {

std::optional<Rigid3> place_at(const std::optional<Eigen::Vector3d>& center_m) {
  return center_m ? std::optional(Rigid3::from_translation(*center_m)) : std::nullopt;
}

void add_track_events(const std::vector<AnnotatedObject>& placements, const ModelLibrary& library, int num_views,
                      std::vector<AnnotatedEvent>& events) {
  const auto add = [&](int view, AnnotatedEventKind kind, const AnnotatedObject* before, const AnnotatedObject* after) {
    const AnnotatedObject& one = after != nullptr ? *after : *before;
    AnnotatedEvent event;
    event.view = view;
    event.kind = kind;
    event.track = one.track;
    event.object = one.object;
    event.name = library.objects[static_cast<std::size_t>(one.object)].name;
    if (before != nullptr) event.world_from_object_before = before->world_from_object;
    if (after != nullptr) event.world_from_object_after = after->world_from_object;
    events.push_back(std::move(event));
  };
  const AnnotatedObject* previous = nullptr;
  for (const AnnotatedObject& next : placements) {
    if (previous != nullptr && next.first_view <= previous->last_view + 1) {
      add(next.first_view, AnnotatedEventKind::kMoved, previous, &next);
    } else {
      if (previous != nullptr) add(previous->last_view + 1, AnnotatedEventKind::kRemoved, previous, nullptr);
      if (next.first_view > 0) add(next.first_view, AnnotatedEventKind::kAdded, nullptr, &next);
    }
    previous = &next;
  }
  if (previous != nullptr && previous->last_view + 1 < num_views)
    add(previous->last_view + 1, AnnotatedEventKind::kRemoved, previous, nullptr);
}

void sort_by_time(std::vector<AnnotatedObject>& placements) {
  std::ranges::sort(placements, {}, [](const AnnotatedObject& o) { return std::tuple(o.first_view, o.id); });
}

}  // namespace

std::vector<AnnotatedObject> placements_of_track(const AnnotationDocument& document, int track) {
  std::vector<AnnotatedObject> placements;
  for (const auto& [id, object] : document.objects)
    if (object.track == track) placements.push_back(object);
  sort_by_time(placements);
  return placements;
}

std::map<int, std::vector<AnnotatedObject>> placements_by_track(const AnnotationDocument& document) {
  std::map<int, std::vector<AnnotatedObject>> tracks;
  for (const auto& [id, object] : document.objects) tracks[object.track].push_back(object);
  for (auto& [track, placements] : tracks) sort_by_time(placements);
  return tracks;
}

std::vector<AnnotatedEvent> derive_events(const AnnotationDocument& document, const ModelLibrary& library,
                                          int num_views) {
  std::vector<AnnotatedEvent> events;
  for (const auto& [track, placements] : placements_by_track(document))
    add_track_events(placements, library, num_views, events);
  for (const auto& [id, e] : document.unknown_events) {
    AnnotatedEvent event;
    event.view = e.view;
    event.kind = e.kind;
    event.name = e.name;
    event.world_from_object_before = place_at(e.before_in_world_m);
    event.world_from_object_after = place_at(e.after_in_world_m);
    events.push_back(std::move(event));
  }
  std::ranges::stable_sort(events, {}, &AnnotatedEvent::view);
  return events;
}

}  // namespace resight
