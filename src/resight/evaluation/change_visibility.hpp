// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <vector>

#include "resight/evaluation/change_truth.hpp"
#include "resight/evaluation/match_detections.hpp"
#include "resight/sensor/rgbd_frame.hpp"

namespace resight {

/// What the views show of a change, and since when; -1 = never.
struct ChangeVisibility {
  int before_view = -1;  ///< First view, from the change on, that looks at the place left: its centre is in the image
                         ///< and not hidden, and none of its kind is there again.
  int after_view = -1;   ///< First view, from the change on, with the object visible at its new place.
  int last_there_view = -1;  ///< Last view before the change, since it came there, with it visible at the place left.
  int last_free_view = -1;   ///< Last view before the change that looks at the new place, with none of its kind there.
};

/// Finds the sight of each change, view by view (in order). The views up to the last one added count.
class ChangeVisibilityFinder {
 public:
  /// All must outlive the finder; truth.changes must be there.
  ChangeVisibilityFinder(const ModelLibrary& library, const SequenceTruth& truth,
                         const MatchDetectionsOptions& options = {});
  void add_view(const RgbdFrame& frame);
  [[nodiscard]] const std::vector<ChangeVisibility>& sights() const { return sights_; }

 private:
  [[nodiscard]] bool shows(const RgbdFrame& frame, const std::string& object, const Rigid3& world_from_object,
                           const ObjectModel& model) const;
  [[nodiscard]] int find_arrival_before(const TrueChange& change) const;

  const ModelLibrary& library_;
  const SequenceTruth& truth_;
  MatchDetectionsOptions options_;
  std::vector<ChangeVisibility> sights_;
  std::vector<int> stands_since_;  // by change: the first view with the object at the place that it leaves
  int view_ = 0;
};

}  // namespace resight
