// SPDX-License-Identifier: Apache-2.0
#include "resight/history/placement_memory.hpp"

#include <algorithm>

#include "resight/history/body_overlap.hpp"

namespace resight {

void PlacementMemory::forget_old_placements() {
  std::erase_if(former_placements_,
                [&](const FormerPlacement& placement) { return !reaches_back_to(placement.seen_view); });
}

std::optional<int> PlacementMemory::last_free_view(const ObjectObservation& observed, int view,
                                                   std::span<const Track> tracks,
                                                   const PresenceOptions& presence) const {
  const PointCloud& surface = library_.objects[static_cast<std::size_t>(observed.object)].surface;
  return std::max(depth_.last_seen_free(surface, observed.world_from_object, presence),
                  last_occupied_view(observed, view, tracks));
}

// The last view that showed another object in the space of the observed one.
std::optional<int> PlacementMemory::last_occupied_view(const ObjectObservation& observed, int view,
                                                       std::span<const Track> tracks) const {
  const auto model_of = [&](int object) -> const ObjectModel& {
    return library_.objects[static_cast<std::size_t>(object)];
  };
  std::optional<int> last;
  const auto check = [&](int object, const Rigid3& world_from_object, int seen_view) {
    if (object != observed.object && seen_view > last.value_or(-1) && seen_view < view && reaches_back_to(seen_view) &&
        is_mostly_within(model_of(observed.object), observed.world_from_object, model_of(object), world_from_object))
      last = seen_view;
  };
  for (const FormerPlacement& placement : former_placements_)
    check(placement.object, placement.world_from_object, placement.seen_view);
  for (const Track& track : tracks) check(track.object, track.world_from_object, track.seen_view);
  return last;
}

}  // namespace resight
