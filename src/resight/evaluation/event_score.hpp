// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <span>
#include <vector>

#include "resight/evaluation/recognition_score.hpp"
#include "resight/evaluation/seen_changes.hpp"

namespace resight {

struct EventScore {
  RecognitionScore events;      ///< Right: same object and kind, both places right.
  RecognitionScore departures;  ///< Of "moved" the old place, of "removed" the place.
  RecognitionScore arrivals;    ///< Of "moved" the new place, of "added" the place.
  std::vector<int> delays;      ///< Views from when it could be known to the report; one per right event.
  EventScore& operator+=(const EventScore& other);
};

/// Scores the reported changes against the true ones of known objects. Pairs are chosen in the order of their views,
/// one to one; a report before the change is wrong. A move of which the views show only one side (see ChangeVisibility)
/// is to them a removal or an addition, and right as that, too; what the views cannot tell from what happened is right
/// as well (reconcile_with_reports()). Changes that no view shows are neither hits nor misses, nor are reports of them.
[[nodiscard]] EventScore score_events(std::span<const TrueChange> changes, std::span<const ChangeVisibility> sights,
                                      std::span<const ReportedChange> reported, const ModelLibrary& library,
                                      const MatchDetectionsOptions& options = {});

}  // namespace resight
