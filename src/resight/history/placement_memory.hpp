// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>
#include <span>
#include <vector>

#include "resight/history/depth_history.hpp"
#include "resight/history/object_observation.hpp"
#include "resight/history/track.hpp"
#include "resight/models/object_model.hpp"

namespace resight {

/// Remembers, for the last DepthHistoryOptions::max_views views, which places were free or occupied by other objects.
class PlacementMemory {
 public:
  /// `library` must outlive it.
  PlacementMemory(const ModelLibrary& library, const DepthHistoryOptions& options)
      : library_(library), depth_(options) {}

  void add_view(int view, const RgbdFrame& frame) { depth_.add(view, frame); }
  void add_former_placement(const Track& track) {
    former_placements_.push_back({track.object, track.world_from_object, track.seen_view});
  }
  /// Forgets the former placements that are older than the remembered views.
  void forget_old_placements();

  /// Last view before `view` in which the observed object was not at this place: the view saw free space there, or
  /// another object.
  [[nodiscard]] std::optional<int> last_free_view(const ObjectObservation& observed, int view,
                                                  std::span<const Track> tracks, const PresenceOptions& presence) const;
  /// Whether `view`, or an older one, is still remembered.
  [[nodiscard]] bool reaches_back_to(int view) const { return depth_.reaches_back_to(view); }

 private:
  [[nodiscard]] std::optional<int> last_occupied_view(const ObjectObservation& observed, int view,
                                                      std::span<const Track> tracks) const;

  const ModelLibrary& library_;
  DepthHistory depth_;
  std::vector<FormerPlacement> former_placements_;
};

}  // namespace resight
