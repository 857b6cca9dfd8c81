// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>
#include <span>
#include <vector>

#include "resight/evidence/object_presence.hpp"
#include "resight/models/object_model.hpp"
#include "resight/recognition/scene_update.hpp"
#include "resight/recognition/tracked_object.hpp"

namespace resight {

/// What was recognised and may well be something else: nothing is told of it before a view is sure, but it is looked
/// for as anything known is.
class TentativeTracks {
 public:
  /// `library` must outlive it.
  explicit TentativeTracks(const ModelLibrary& library) : library_(library) {}

  /// Takes a detection over: the one of its kind whose place it is in, or else a new one with the track `new_id`. Two
  /// of one view are two. Returns its track.
  int keep(const Detection& detection, int view, int new_id);
  /// Forgets the one whose place the detection is in, unless it is of this view itself, and returns it.
  std::optional<TrackedObject> take(const Detection& detection, int view);
  /// Forgets what was last recognised before a view.
  void forget_before(int view);
  /// Forgets what `view` did not recognise and its frame sees gone.
  void forget_gone(int view, const RgbdFrame& frame, const PresenceOptions& options);
  /// Since when the one in the place of the detection has been there; `view` if there is none.
  [[nodiscard]] int since_view(const Detection& detection, int view) const;
  [[nodiscard]] std::span<const TrackedObject> objects() const { return objects_; }

 private:
  [[nodiscard]] std::size_t find(const Detection& detection, int before_view) const;

  const ModelLibrary& library_;
  std::vector<TrackedObject> objects_;
};

}  // namespace resight
