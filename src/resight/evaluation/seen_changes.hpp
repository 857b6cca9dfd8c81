// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "resight/evaluation/change_visibility.hpp"
#include "resight/history/object_event.hpp"

namespace resight {

/// A change event that a recogniser reports, with the object's name.
struct ReportedChange {
  int view = 0;
  ObjectEventKind kind = ObjectEventKind::kMoved;
  std::string object;
  std::optional<Rigid3> world_from_object_before;
  std::optional<Rigid3> world_from_object_after;
  int reported_view = 0;  ///< The view with which the report came, at or after `view`, at which the change happened.
};

/// A true change, and what the views show of it.
struct SeenChange : TrueChange {
  ChangeVisibility visibility;
  /// Whether the views show the object at its former place, and later the place without it.
  [[nodiscard]] bool shows_departure() const;
  /// Whether the views show the arrival. An object at a place that was not observed before may have been there all
  /// along, unless its departure from elsewhere was observed.
  [[nodiscard]] bool shows_arrival() const;
  [[nodiscard]] bool counts() const { return shows_departure() || shows_arrival(); }
  /// One side of a move, as the removal or addition it would be alone. Other changes are returned unchanged.
  [[nodiscard]] SeenChange departure() const;
  /// The other side of a move; see departure().
  [[nodiscard]] SeenChange arrival() const;
  /// First view by which all visible sides of the change are known; -1 if none is visible.
  [[nodiscard]] int known_since() const;
};

/// Decides whether a report matches a true change.
class ChangeMatcher {
 public:
  /// Both arguments must outlive the matcher. All matched objects must be in the library.
  ChangeMatcher(const ModelLibrary& library, const MatchDetectionsOptions& options)
      : library_(library), options_(options) {}
  [[nodiscard]] bool same_place(const std::string& object, const std::optional<Rigid3>& a,
                                const std::optional<Rigid3>& b) const;
  /// True for the change itself or, if the views show only one side of it, for that side.
  [[nodiscard]] bool fits(const SeenChange& truth, const ReportedChange& report) const;

 private:
  [[nodiscard]] bool same_change(const TrueChange& truth, const ReportedChange& report) const;

  const ModelLibrary& library_;
  const MatchDetectionsOptions& options_;
};

/// Index of the truth of each report, or -1. In order, each report takes the first remaining truth that fits and is not
/// of a later view; one that does not count only if no other fits.
template <typename Truth, typename Report, typename Fits, typename Counts>
[[nodiscard]] std::vector<int> match_in_order(const std::vector<Truth>& truths, const std::vector<Report>& reports,
                                              Fits&& fits, Counts&& counts) {
  std::vector<int> truth_of(reports.size(), -1);
  std::vector<char> used(truths.size(), 0);
  for (std::size_t r = 0; r < reports.size(); ++r)
    for (const bool must_count : {true, false})
      for (std::size_t t = 0; t < truths.size() && truth_of[r] < 0; ++t) {
        if (used[t] || truths[t].view > reports[r].view || counts(truths[t]) != must_count ||
            !fits(truths[t], reports[r]))
          continue;
        used[t] = 1;
        truth_of[r] = static_cast<int>(t);
      }
  return truth_of;
}

/// Rewrites the true changes as the reports describe them, where no view can tell the difference. Objects of one model
/// are indistinguishable: only the time of observation tells which of two departed objects arrived elsewhere, or
/// whether an arrived object is a departed one. A reported move that did not happen, but whose former place was left
/// and whose new place was taken, stands for these two sides if they can have happened at one moment: after the last
/// views that show the former place occupied and the new one free, and before the first ones that show the opposite.
/// The remaining sides become changes of their own. Input and output are ordered by view.
[[nodiscard]] std::vector<SeenChange> reconcile_with_reports(std::vector<SeenChange> truths,
                                                             const std::vector<ReportedChange>& reports,
                                                             const ChangeMatcher& matcher);

}  // namespace resight
