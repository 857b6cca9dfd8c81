// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <span>
#include <vector>

#include "resight/evaluation/recognition_score.hpp"
#include "resight/evaluation/seen_changes.hpp"

namespace resight {

/// Scores of reported events, and of their two sides separately.
struct EventScore {
  RecognitionScore events;  ///< Right if object, kind and both placements are right.
  /// Former place of "moved" and "removed" events.
  RecognitionScore departures;
  RecognitionScore arrivals;  ///< New place of "moved" and "added" events.
  /// Views from when a change could be known to its report; one per right event.
  std::vector<int> delays;
  EventScore& operator+=(const EventScore& other);
};

/// Scores reported changes against the true changes of library objects. Pairs are chosen one to one, in order of their
/// views, those with changes that no view shows last; a report before its change is wrong. If the views show only one
/// side of a move (see ChangeVisibility), a report of that removal or addition is right too, as is a report that the
/// views cannot distinguish from the truth (reconcile_with_reports()). Changes that no view shows are neither hits nor
/// misses, and reports of them are ignored. Throws std::invalid_argument unless `visibilities` has one entry per change
/// and all reported objects are in the library.
[[nodiscard]] EventScore score_events(std::span<const TrueChange> changes,
                                      std::span<const ChangeVisibility> visibilities,
                                      std::span<const ReportedChange> reported, const ModelLibrary& library,
                                      const MatchDetectionsOptions& options = {});

}  // namespace resight
