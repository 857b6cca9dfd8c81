// SPDX-License-Identifier: Apache-2.0
#include "resight/annotation/annotation_document.hpp"

#include <fmt/format.h>

#include <cstdint>
#include <utility>

#include "resight/core/names.hpp"

namespace resight {
namespace {

constexpr double kMaxPosition_m = 1e4;
constexpr int kMaxNumber = 1000000;  // Of placements and tracks.

using Undo = Result<AnnotationChange>;

/// The number of a view in messages. The page shows them, and it counts views from 1.
std::int64_t shown(int view) { return std::int64_t{view} + 1; }

bool is_below(int number, int count) { return number >= 0 && number < count; }

bool is_near(const Eigen::Vector3d& position_m) {
  return position_m.allFinite() && position_m.cwiseAbs().maxCoeff() <= kMaxPosition_m;
}

// Numbers are those that the journal keeps: it is checked again when it is read.
Result<void> check_object(const AnnotatedObject& object, const AnnotationLimits& limits) {
  if (!is_below(object.object, limits.num_objects)) return Error{fmt::format("there is no object {}", object.object)};
  if (!is_below(object.first_view, limits.num_views) || !is_below(object.last_view, limits.num_views))
    return Error{
        fmt::format("views {} to {} are not in the sequence", shown(object.first_view), shown(object.last_view))};
  if (object.last_view < object.first_view)
    return Error{fmt::format("the placement ends at view {} before it begins at view {}", shown(object.last_view),
                             shown(object.first_view))};
  if (!object.world_from_object.is_rigid() || !is_near(object.world_from_object.translation))
    return Error{"the pose is not a rigid motion within 10 km"};
  if (object.id < 0 || object.track < 0 || object.id > kMaxNumber || object.track > kMaxNumber)
    return Error{"the number of a placement or track is out of range"};
  return {};
}

Undo apply_one(AnnotationDocument& document, PutObject& change, const AnnotationLimits& limits) {
  AnnotatedObject& object = change.object;
  if (object.id == -1) object.id = document.next_id;
  if (object.track == -1) object.track = document.next_track;
  if (const auto valid = check_object(object, limits); !valid) return valid.error();
  document.next_id = std::max(document.next_id, object.id + 1);
  document.next_track = std::max(document.next_track, object.track + 1);
  const auto old = document.objects.find(object.id);
  const AnnotationChange undo = old == document.objects.end() ? AnnotationChange(DropObject{object.id})
                                                              : AnnotationChange(PutObject{old->second});
  document.objects[object.id] = object;
  return undo;
}

Undo apply_one(AnnotationDocument& document, DropObject& change, const AnnotationLimits&) {
  const auto old = document.objects.find(change.id);
  if (old == document.objects.end()) return Error{fmt::format("there is no placement {}", change.id)};
  const AnnotationChange undo = PutObject{old->second};
  document.objects.erase(old);
  return undo;
}

Undo apply_one(AnnotationDocument& document, JudgeRegion& change, const AnnotationLimits& limits) {
  RegionJudgement& judgement = change.judgement;
  if (!is_below(judgement.region.view, limits.num_views))
    return Error{fmt::format("there is no view {}", shown(judgement.region.view))};
  if (!is_near(judgement.region.center_in_world_m)) return Error{"the region is not within 10 km"};
  if (judgement.track < -1 || judgement.track > kMaxNumber) return Error{"the track is out of range"};
  if (const auto valid = check_runs(judgement.mask.value_or(PixelRuns())); !valid) return valid.error();
  const auto old = document.regions.find(judgement.region);
  const RegionJudgement before = old == document.regions.end() ? RegionJudgement{.region = judgement.region,
                                                                                 .verdict = RegionVerdict::kOpen,
                                                                                 .track = -1,
                                                                                 .mask = std::nullopt}
                                                               : old->second;
  if (std::exchange(change.keeps_mask, false)) judgement.mask = before.mask;
  if (judgement.verdict == RegionVerdict::kOpen && !judgement.mask)
    document.regions.erase(judgement.region);
  else
    document.regions[judgement.region] = judgement;
  return AnnotationChange(JudgeRegion{before});
}

Undo apply_one(AnnotationDocument& document, CheckView& change, const AnnotationLimits& limits) {
  if (!is_below(change.view, limits.num_views)) return Error{fmt::format("there is no view {}", shown(change.view))};
  const bool was_checked = document.checked_views.contains(change.view);
  if (change.is_checked)
    document.checked_views.insert(change.view);
  else
    document.checked_views.erase(change.view);
  return AnnotationChange(CheckView{change.view, was_checked});
}

Result<void> check_event(const UnknownObjectEvent& event, const AnnotationLimits& limits) {
  if (!is_below(event.view, limits.num_views) || event.view == 0)
    return Error{fmt::format("no change can happen before view {}", shown(event.view))};
  if (const auto valid = check_object_name(event.name); !valid) return valid;
  if (event.before_in_world_m.has_value() != (event.kind != AnnotatedEventKind::kAdded) ||
      event.after_in_world_m.has_value() != (event.kind != AnnotatedEventKind::kRemoved))
    return Error{"an added thing has a place afterwards, a removed one before, a moved one both"};
  if (!is_near(event.before_in_world_m.value_or(Eigen::Vector3d::Zero())) ||
      !is_near(event.after_in_world_m.value_or(Eigen::Vector3d::Zero())))
    return Error{"a place is not within 10 km"};
  if (event.id < 0 || event.id > kMaxNumber) return Error{"the number of an event is out of range"};
  return {};
}

Undo apply_one(AnnotationDocument& document, PutUnknownEvent& change, const AnnotationLimits& limits) {
  UnknownObjectEvent& event = change.event;
  if (event.id == -1) event.id = document.next_id;
  if (const auto valid = check_event(event, limits); !valid) return valid.error();
  document.next_id = std::max(document.next_id, event.id + 1);
  const auto old = document.unknown_events.find(event.id);
  const AnnotationChange undo = old == document.unknown_events.end() ? AnnotationChange(DropUnknownEvent{event.id})
                                                                     : AnnotationChange(PutUnknownEvent{old->second});
  document.unknown_events[event.id] = event;
  return undo;
}

Undo apply_one(AnnotationDocument& document, DropUnknownEvent& change, const AnnotationLimits&) {
  const auto old = document.unknown_events.find(change.id);
  if (old == document.unknown_events.end()) return Error{fmt::format("there is no event {}", change.id)};
  const AnnotationChange undo = PutUnknownEvent{old->second};
  document.unknown_events.erase(old);
  return undo;
}

}  // namespace

Result<AnnotationChange> apply_change(AnnotationDocument& document, AnnotationChange& change,
                                      const AnnotationLimits& limits) {
  return std::visit([&](auto& one) { return apply_one(document, one, limits); }, change);
}

}  // namespace resight
