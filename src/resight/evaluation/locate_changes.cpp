// SPDX-License-Identifier: Apache-2.0
#include "resight/evaluation/locate_changes.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <string>
#include <utility>

#include "resight/models/pose_distance.hpp"

namespace resight {
namespace {

using Places = std::vector<Rigid3>;

bool needs_place_before(const TrueChange& change) {
  return change.kind != ObjectEventKind::kAdded && !change.world_from_object_before;
}
bool needs_place_after(const TrueChange& change) {
  return change.kind != ObjectEventKind::kRemoved && !change.world_from_object_after;
}

Places places_in(const TruthView& view, const std::string& object) {
  Places places;
  for (const GroundTruthObject& candidate : view.objects)
    if (candidate.object == object) places.push_back(view.world_from_camera * candidate.camera_from_object);
  return places;
}

/// In the first of the views that has the object; empty if none has.
template <typename Iterator>
Places first_places(Iterator begin, Iterator end, const std::string& object) {
  for (Iterator view = begin; view != end; ++view)
    if (Places places = places_in(*view, object); !places.empty()) return places;
  return {};
}

/// Views from one change of an object to the next.
struct ViewsAround {
  std::span<const TruthView> before;
  std::span<const TruthView> after;
};

ViewsAround views_around(std::span<const TruthView> views, const TrueChange& change,
                         std::span<const TrueChange> changes) {
  int begin = 0;
  int end = static_cast<int>(views.size());
  const int split = std::min(change.view, end);
  for (const TrueChange& other : changes) {
    if (other.object != change.object) continue;
    if (other.view < split) begin = std::max(begin, other.view);
    if (other.view > split) end = std::min(end, other.view);
  }
  const auto part = [&](int from, int to) {
    return views.subspan(static_cast<std::size_t>(from), static_cast<std::size_t>(to - from));
  };
  return {part(begin, split), part(split, end)};
}

/// The place that is not among the others, if there is one such place.
std::optional<Rigid3> only_place(Places places, const Places& others, const ObjectModel& model) {
  constexpr double kMaxOffset_m = 0.01;          // Annotations jitter.
  constexpr double kMaxRotation_rad = 0.174533;  // 10 deg
  std::erase_if(places, [&](const Rigid3& place) {
    return std::ranges::any_of(others, [&](const Rigid3& other) {
      return is_same_place(model, place, other, {kMaxOffset_m, kMaxRotation_rad});
    });
  });
  return places.size() == 1 ? std::optional(places.front()) : std::nullopt;
}

bool is_annotated(std::span<const TruthView> views, const std::string& object) {
  return std::ranges::any_of(views, [&](const TruthView& view) { return !places_in(view, object).empty(); });
}

Result<void> locate(const ViewsAround& views, const ObjectModel& model, TrueChange& change) {
  const Places before = first_places(views.before.rbegin(), views.before.rend(), change.object);
  const Places after = first_places(views.after.begin(), views.after.end(), change.object);
  if (needs_place_before(change)) change.world_from_object_before = only_place(before, after, model);
  if (needs_place_after(change)) change.world_from_object_after = only_place(after, before, model);
  if (!needs_place_before(change) && !needs_place_after(change)) return {};
  return Error{fmt::format("the ground truth does not show which '{}' was {} before view {}", change.object,
                           to_string(change.kind), change.view)};
}

}  // namespace

Result<void> locate_changes(std::span<const TruthView> views, const ModelLibrary& library,
                            std::vector<TrueChange>& changes) {
  std::vector<TrueChange> kept;
  for (const TrueChange& change : changes) {
    const int model = library.find(change.object);
    const bool is_complete = !needs_place_before(change) && !needs_place_after(change);
    if (!is_complete && model < 0) {
      if (is_annotated(views, change.object)) continue;
      return Error{fmt::format("'{}' is neither in the library nor in the ground truth", change.object)};
    }
    kept.push_back(change);
    if (is_complete) continue;
    if (auto done =
            locate(views_around(views, change, changes), library.objects[static_cast<std::size_t>(model)], kept.back());
        !done)
      return done;
  }
  changes = std::move(kept);
  return {};
}

}  // namespace resight
