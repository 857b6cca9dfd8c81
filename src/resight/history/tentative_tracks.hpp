// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>
#include <span>
#include <vector>

#include "resight/evidence/object_presence.hpp"
#include "resight/history/object_observation.hpp"
#include "resight/history/tracked_object.hpp"
#include "resight/models/object_model.hpp"
#include "resight/sensor/rgbd_frame.hpp"

namespace resight {

/// Recognised objects whose score is too low to report them. They are searched for and verified like all tracked
/// objects; no event is reported for them before a view confirms them.
class TentativeTracks {
 public:
  /// `library` must outlive it.
  explicit TentativeTracks(const ModelLibrary& library) : library_(library) {}

  /// Updates the track of this kind at the place of the observation, or begins one with the number `new_id`. Two
  /// observations of one view are two objects. Returns the number of the track.
  int update(const ObjectObservation& observed, int view, int new_id);
  /// Removes and returns the track of an earlier view at the place of the observation: it is confirmed now.
  std::optional<TrackedObject> promote(const ObjectObservation& observed, int view);
  /// Forgets the tracks that were last recognised before `view`.
  void forget_before(int view);
  /// Forgets the tracks that `view` did not recognise and whose places its frame sees free.
  void forget_gone(int view, const RgbdFrame& frame, const PresenceOptions& options);
  /// First view of the track at the place of the observation; `view` if there is none.
  [[nodiscard]] int since_view(const ObjectObservation& observed, int view) const;
  [[nodiscard]] std::span<const TrackedObject> objects() const { return objects_; }

 private:
  [[nodiscard]] std::size_t find(const ObjectObservation& observed, int before_view) const;

  const ModelLibrary& library_;
  std::vector<TrackedObject> objects_;
};

}  // namespace resight
