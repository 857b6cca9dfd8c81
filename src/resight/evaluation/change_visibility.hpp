// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <vector>

#include "resight/evaluation/change_truth.hpp"
#include "resight/evaluation/match_detections.hpp"
#include "resight/sensor/rgbd_frame.hpp"

namespace resight {

/// What the views show of a change, by view number; -1 = never.
struct ChangeVisibility {
  /// First view from the change on, and until such an object comes back, that observes the former place: its centre is
  /// in the image and not occluded, and no object of this kind is there.
  int before_view = -1;
  /// First view from the change on, and until it leaves again, with the object visible at its new place.
  int after_view = -1;
  /// Last view before the change, and since the object arrived there, with it visible at the former place.
  int last_there_view = -1;
  /// Last view before the change, and since such an object left there, that observes the new place without one.
  int last_free_view = -1;
};

/// Determines the visibility of each change, view by view (in order), up to the last view added.
class ChangeVisibilityFinder {
 public:
  /// All arguments must outlive the finder. Throws std::invalid_argument without truth.changes.
  ChangeVisibilityFinder(const ModelLibrary& library, const SequenceTruth& truth,
                         const MatchDetectionsOptions& options = {});
  void add_view(const RgbdFrame& frame);
  [[nodiscard]] const std::vector<ChangeVisibility>& visibilities() const { return visibilities_; }

 private:
  [[nodiscard]] bool shows(const RgbdFrame& frame, const std::string& object, const Rigid3& world_from_object,
                           const ObjectModel& model) const;
  /// The views between the changes before and after it at the same places.
  struct Limits {
    int there_since = 0;
    int free_since = 0;
    int free_until = 0;   ///< The former place; not included.
    int there_until = 0;  ///< At the new place; not included.
  };
  [[nodiscard]] Limits find_limits(const TrueChange& change) const;

  const ModelLibrary& library_;
  const SequenceTruth& truth_;
  MatchDetectionsOptions options_;
  std::vector<ChangeVisibility> visibilities_;
  std::vector<Limits> limits_;  // Per change.
  int view_ = 0;
};

}  // namespace resight
