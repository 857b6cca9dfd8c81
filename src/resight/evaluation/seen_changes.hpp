// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "resight/evaluation/change_visibility.hpp"

namespace resight {

/// An event that a recogniser reports, by name.
struct ReportedChange {
  int view = 0;
  ObjectEventKind kind = ObjectEventKind::kMoved;
  std::string object;
  std::optional<Rigid3> world_from_object_before;
  std::optional<Rigid3> world_from_object_after;
};

/// A change, and what the views show of it.
struct SeenChange : TrueChange {
  ChangeVisibility sight;
  [[nodiscard]] bool shows_departure() const;
  /// What comes where no view looked before may have been there, unless it was seen to leave elsewhere.
  [[nodiscard]] bool shows_arrival() const;
  [[nodiscard]] bool counts() const { return shows_departure() || shows_arrival(); }
  /// One side of a move, as the removal or the addition that it is alone; other changes as they are.
  [[nodiscard]] SeenChange departure() const;
  [[nodiscard]] SeenChange arrival() const;
  /// The view by which all that is shown can be known; -1 if nothing is.
  [[nodiscard]] int known_since() const;
};

/// When a report says what happened.
class ChangeMatcher {
 public:
  /// Both must outlive the matcher; every object that is matched must be in the library.
  ChangeMatcher(const ModelLibrary& library, const MatchDetectionsOptions& options)
      : library_(library), options_(options) {}
  [[nodiscard]] bool same_place(const std::string& object, const std::optional<Rigid3>& a,
                                const std::optional<Rigid3>& b) const;
  /// The change itself or, where only one side of it is shown, that side.
  [[nodiscard]] bool fits(const SeenChange& truth, const ReportedChange& report) const;

 private:
  [[nodiscard]] bool same_change(const TrueChange& truth, const ReportedChange& report) const;

  const ModelLibrary& library_;
  const MatchDetectionsOptions& options_;
};

/// The number of the truth of each report, or -1: in the order of the reports each takes the first one left that is not
/// of a later view and fits.
template <typename Truth, typename Report, typename Fits>
[[nodiscard]] std::vector<int> match_in_order(const std::vector<Truth>& truths, const std::vector<Report>& reports,
                                              Fits&& fits) {
  std::vector<int> truth_of(reports.size(), -1);
  std::vector<char> used(truths.size(), 0);
  for (std::size_t r = 0; r < reports.size(); ++r)
    for (std::size_t t = 0; t < truths.size() && truth_of[r] < 0; ++t) {
      if (used[t] || truths[t].view > reports[r].view || !fits(truths[t], reports[r])) continue;
      used[t] = 1;
      truth_of[r] = static_cast<int>(t);
    }
  return truth_of;
}

/// The changes as the reports tell them, where no view can tell the difference. Objects of one model are alike: which
/// of two that left is the one that came, or whether what came is what left, the views show only by when they show it.
/// A reported move that is none, but whose old place was left and whose new place was come to, stands for these two
/// sides if it can have happened at one moment: after the last views that show the one still there and the other free,
/// and before the first ones that show it gone and come. What remains of the two changes are changes of their own. Both
/// ordered by view.
[[nodiscard]] std::vector<SeenChange> reconcile_with_reports(std::vector<SeenChange> truths,
                                                             const std::vector<ReportedChange>& reports,
                                                             const ChangeMatcher& matcher);

}  // namespace resight
