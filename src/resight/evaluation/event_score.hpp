// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <span>
#include <string>
#include <vector>

#include "resight/evaluation/change_truth.hpp"
#include "resight/evaluation/match_detections.hpp"
#include "resight/sensor/rgbd_frame.hpp"

namespace resight {

/// An event that a recogniser reports, by name.
struct ReportedChange {
  int view = 0;
  ObjectEventKind kind = ObjectEventKind::kMoved;
  std::string object;
  std::optional<Rigid3> world_from_object_before;
  std::optional<Rigid3> world_from_object_after;
};

/// What the views show of a change, and since when; -1 = never.
struct ChangeSight {
  int before_view = -1;  ///< First view, from the change on, that looks at the place left: its centre is in the image
                         ///< and not hidden.
  int after_view = -1;   ///< First view, from the change on, with the object visible at its new place.
  bool was_seen = true;  ///< A view before the change, since it came there, had the object visible at the place left.
  bool place_was_seen = true;  ///< A view before the change looked at the new place.
};

/// Finds the sight of each change, view by view (in order). The views up to the last one added count.
class ChangeSightFinder {
 public:
  /// All must outlive the finder; truth.changes must be there.
  ChangeSightFinder(const ModelLibrary& library, const SequenceTruth& truth,
                    const MatchDetectionsOptions& options = {});
  void add_view(const RgbdFrame& frame);
  [[nodiscard]] const std::vector<ChangeSight>& sights() const { return sights_; }

 private:
  [[nodiscard]] bool shows(const RgbdFrame& frame, const std::string& object, const Rigid3& world_from_object,
                           const ObjectModel& model) const;
  [[nodiscard]] int find_arrival_before(const TrueChange& change) const;

  const ModelLibrary& library_;
  const SequenceTruth& truth_;
  MatchDetectionsOptions options_;
  std::vector<ChangeSight> sights_;
  std::vector<int> stands_since_;  // by change: the first view with the object at the place that it leaves
  int view_ = 0;
};

struct EventScore {
  RecognitionScore events;      ///< Right: same object and kind, both places right.
  RecognitionScore departures;  ///< Of "moved" the old place, of "removed" the place.
  RecognitionScore arrivals;    ///< Of "moved" the new place, of "added" the place.
  std::vector<int> delays;      ///< Views from when it could be known to the report; one per right event.
  EventScore& operator+=(const EventScore& other);
};

/// Scores the reported changes against the true ones of known objects. Pairs are chosen in the order of their views,
/// one to one; a report before the change is wrong. A move of which the views show only one side (see ChangeSight) is
/// to them a removal or an addition, and right as that, too. Changes that no view shows are neither hits nor misses,
/// nor are reports of them.
[[nodiscard]] EventScore score_events(std::span<const TrueChange> changes, std::span<const ChangeSight> sights,
                                      std::span<const ReportedChange> reported, const ModelLibrary& library,
                                      const MatchDetectionsOptions& options = {});

}  // namespace resight
