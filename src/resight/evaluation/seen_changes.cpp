// SPDX-License-Identifier: Apache-2.0
#include "resight/evaluation/seen_changes.hpp"

#include <algorithm>
#include <utility>

namespace resight {
namespace {

// A single move at some time between two views is consistent with all views.
bool may_be_one_move(const SeenChange& left, const SeenChange& came) {
  return std::max(left.visibility.last_there_view, came.visibility.last_free_view) <
         std::min(left.visibility.before_view, came.visibility.after_view);
}

SeenChange join(const SeenChange& left, const SeenChange& came) {
  SeenChange move = left;
  move.view = std::max(left.view, came.view);
  move.kind = ObjectEventKind::kMoved;
  move.world_from_object_after = came.world_from_object_after;
  move.visibility.after_view = came.visibility.after_view;
  move.visibility.last_free_view = came.visibility.last_free_view;
  return move;
}

void insert_by_view(SeenChange change, std::vector<SeenChange>& truths) {
  truths.insert(std::ranges::upper_bound(truths, change.view, {}, &SeenChange::view), std::move(change));
}

// Replaces two changes by the move that joins their sides, and by the remaining sides.
void rewrite_as_move(std::size_t left_index, std::size_t came_index, std::vector<SeenChange>& truths) {
  const SeenChange left = truths[left_index];
  const SeenChange came = truths[came_index];
  truths.erase(truths.begin() + static_cast<std::ptrdiff_t>(std::max(left_index, came_index)));
  truths.erase(truths.begin() + static_cast<std::ptrdiff_t>(std::min(left_index, came_index)));
  insert_by_view(join(left, came), truths);
  if (left.kind == ObjectEventKind::kMoved) {
    SeenChange arrival = left.arrival();
    if (left.shows_arrival())  // It was not at the new place while it was visible at the former one.
      arrival.visibility.last_free_view = std::max(arrival.visibility.last_free_view, left.visibility.last_there_view);
    insert_by_view(arrival, truths);
  }
  if (came.kind == ObjectEventKind::kMoved) insert_by_view(came.departure(), truths);
}

bool rewrite_one(const ReportedChange& report, const std::vector<char>& used, const ChangeMatcher& matcher,
                 std::vector<SeenChange>& truths) {
  const auto is_candidate = [&](std::size_t t) {
    return used[t] == 0 && truths[t].object == report.object && truths[t].view <= report.view;
  };
  for (std::size_t l = 0; l < truths.size(); ++l) {
    if (!is_candidate(l) || !truths[l].shows_departure() ||
        !matcher.same_place(report.object, truths[l].world_from_object_before, report.world_from_object_before))
      continue;
    for (std::size_t c = 0; c < truths.size(); ++c) {
      if (c == l || !is_candidate(c) || !truths[c].shows_arrival() || !may_be_one_move(truths[l], truths[c]) ||
          !matcher.same_place(report.object, truths[c].world_from_object_after, report.world_from_object_after))
        continue;
      rewrite_as_move(l, c, truths);
      return true;
    }
  }
  return false;
}

}  // namespace

bool SeenChange::shows_departure() const {
  return world_from_object_before && visibility.last_there_view >= 0 && visibility.before_view >= 0;
}

bool SeenChange::shows_arrival() const {
  return world_from_object_after && visibility.after_view >= 0 && (visibility.last_free_view >= 0 || shows_departure());
}

SeenChange SeenChange::departure() const {
  SeenChange side = *this;
  if (kind != ObjectEventKind::kMoved) return side;
  side.kind = ObjectEventKind::kRemoved;
  side.world_from_object_after.reset();
  return side;
}

SeenChange SeenChange::arrival() const {
  SeenChange side = *this;
  if (kind != ObjectEventKind::kMoved) return side;
  side.kind = ObjectEventKind::kAdded;
  side.world_from_object_before.reset();
  return side;
}

int SeenChange::known_since() const {
  return std::max(shows_departure() ? visibility.before_view : -1, shows_arrival() ? visibility.after_view : -1);
}

bool ChangeMatcher::same_place(const std::string& object, const std::optional<Rigid3>& a,
                               const std::optional<Rigid3>& b) const {
  if (a.has_value() != b.has_value()) return false;
  const ObjectModel& model = library_.objects[static_cast<std::size_t>(library_.find(object))];
  return !a || is_within(compare_poses(*a, *b, model), options_);
}

bool ChangeMatcher::same_change(const TrueChange& truth, const ReportedChange& report) const {
  return truth.object == report.object && truth.kind == report.kind &&
         same_place(truth.object, truth.world_from_object_before, report.world_from_object_before) &&
         same_place(truth.object, truth.world_from_object_after, report.world_from_object_after);
}

bool ChangeMatcher::fits(const SeenChange& truth, const ReportedChange& report) const {
  return same_change(truth, report) || (!truth.shows_arrival() && same_change(truth.departure(), report)) ||
         (!truth.shows_departure() && same_change(truth.arrival(), report));
}

std::vector<SeenChange> reconcile_with_reports(std::vector<SeenChange> truths,
                                               const std::vector<ReportedChange>& reports,
                                               const ChangeMatcher& matcher) {
  // Terminates: no step takes a truth away from the reports, and a step that adds none matches them to better ones.
  for (bool changed = true; changed;) {
    changed = false;
    const std::vector<int> truth_of = match_in_order(
        truths, reports, [&](const SeenChange& t, const ReportedChange& r) { return matcher.fits(t, r); },
        [](const SeenChange& t) { return t.counts(); });
    std::vector<char> used(truths.size(), 0);
    for (const int t : truth_of)
      if (t >= 0) used[static_cast<std::size_t>(t)] = 1;
    for (std::size_t r = 0; r < reports.size() && !changed; ++r)
      changed = truth_of[r] < 0 && reports[r].kind == ObjectEventKind::kMoved &&
                rewrite_one(reports[r], used, matcher, truths);
  }
  return truths;
}

}  // namespace resight
