// SPDX-License-Identifier: Apache-2.0
#include "resight/evaluation/placement_changes.hpp"

#include <algorithm>
#include <limits>
#include <map>

#include "resight/core/check.hpp"

namespace resight {
namespace {

constexpr int kNever = std::numeric_limits<int>::max();

/// A placement and what the views show of it.
struct SeenPlacement {
  const AnnotatedPlacement* placement = nullptr;
  int index = 0;           ///< Among all placements.
  int gone_view = 0;       ///< First view that shows the place without the object; kNever if none.
  int last_free_view = 0;  ///< Last view before the first annotation that shows the place without the object, or -1.
  int previous = -1;       ///< Index of the placement of the same thing before this one; -1 if unknown.
};

// The largest number of placements that exist at one time.
int count_copies(const std::vector<SeenPlacement>& placements) {
  int copies = 0;
  for (const SeenPlacement& p : placements)
    copies = std::max(copies, static_cast<int>(std::ranges::count_if(placements, [&](const SeenPlacement& other) {
                        return other.placement->first_view <= p.placement->first_view &&
                               p.placement->first_view <= other.placement->last_view;
                      })));
  return copies;
}

// The object was at the former place up to the end of one interval and at the new place from the end of the other one
// on. Both can have changed at one moment if the intervals overlap.
bool can_be_one_move(const SeenPlacement& left, const SeenPlacement& came) {
  return std::max(left.placement->last_view, came.last_free_view) <
         std::min(left.gone_view, came.placement->first_view);
}

// Finds `previous` of each placement of one object.
void link_copies(std::vector<SeenPlacement>& placements) {
  std::ranges::stable_sort(placements, {}, [](const SeenPlacement& p) { return p.placement->first_view; });
  int num_unseen = count_copies(placements);
  std::vector<const SeenPlacement*> copies;  // The last placement of each copy that was seen.
  for (SeenPlacement& came : placements) {
    const SeenPlacement** best = nullptr;
    for (const SeenPlacement*& copy : copies) {
      if (copy->placement->last_view >= came.placement->first_view) continue;
      const bool fits = can_be_one_move(*copy, came);
      const bool is_proven = fits && copy->gone_view != kNever && came.last_free_view >= 0;
      if (num_unseen > 0 && !is_proven) continue;
      // Best is a copy whose move explains both; of several, the one that was seen gone first.
      const auto rank = [&](const SeenPlacement& p) { return std::pair(!can_be_one_move(p, came), p.gone_view); };
      if (best == nullptr || rank(*copy) < rank(**best)) best = &copy;
    }
    if (best != nullptr) {
      came.previous = (*best)->index;
      *best = &came;
    } else {
      copies.push_back(&came);
      --num_unseen;
    }
  }
}

TrueChange removal_of(const SeenPlacement& left) {
  return {left.placement->last_view + 1,
          ObjectEventKind::kRemoved,
          left.placement->object,
          true,
          left.placement->last_world_from_object,
          std::nullopt};
}

TrueChange addition_of(const SeenPlacement& came) {
  return {came.last_free_view + 1,
          ObjectEventKind::kAdded,
          came.placement->object,
          true,
          std::nullopt,
          came.placement->first_world_from_object};
}

TrueChange move_of(const SeenPlacement& left, const SeenPlacement& came) {
  return {std::max(left.placement->last_view, came.last_free_view) + 1,
          ObjectEventKind::kMoved,
          left.placement->object,
          true,
          left.placement->last_world_from_object,
          came.placement->first_world_from_object};
}

void add_changes(const std::vector<SeenPlacement>& placements, PlacementChanges& result) {
  std::map<int, const SeenPlacement*> by_index;
  for (const SeenPlacement& p : placements) by_index[p.index] = &p;
  for (const SeenPlacement& came : placements) {
    if (came.previous < 0) {
      if (came.last_free_view >= 0) result.changes.push_back(addition_of(came));
      continue;
    }
    const SeenPlacement& left = *by_index.at(came.previous);
    by_index.erase(came.previous);
    result.has_left[static_cast<std::size_t>(left.index)] = 1;
    if (can_be_one_move(left, came)) {
      result.changes.push_back(move_of(left, came));
    } else {
      result.changes.push_back(removal_of(left));
      result.changes.push_back(addition_of(came));
    }
  }
  for (const auto& [index, left] : by_index) {
    if (left->gone_view == kNever) continue;
    result.has_left[static_cast<std::size_t>(index)] = 1;
    result.changes.push_back(removal_of(*left));
  }
}

}  // namespace

Result<std::vector<ChangeVisibility>> observe_placements(std::span<const AnnotatedPlacement> placements,
                                                         const std::vector<TruthView>& views, const Sequence& sequence,
                                                         const ModelLibrary& library) {
  SequenceTruth truth;
  truth.views = views;
  truth.changes.emplace();
  for (const AnnotatedPlacement& p : placements) {
    truth.changes->push_back(
        {p.last_view + 1, ObjectEventKind::kRemoved, p.object, true, p.last_world_from_object, std::nullopt});
    truth.changes->push_back(
        {p.first_view, ObjectEventKind::kAdded, p.object, true, std::nullopt, p.first_world_from_object});
  }
  ChangeVisibilityFinder finder(library, truth);
  for (int v = 0; v < sequence.num_views(); ++v) {
    const auto frame = sequence.read_view(v);
    if (!frame) return frame.error();
    finder.add_view(*frame);
  }
  std::vector<ChangeVisibility> visibilities;
  for (std::size_t i = 0; i < placements.size(); ++i) {
    const ChangeVisibility& departure = finder.visibilities()[2 * i];
    const ChangeVisibility& arrival = finder.visibilities()[2 * i + 1];
    visibilities.push_back(
        {departure.before_view, arrival.after_view, departure.last_there_view, arrival.last_free_view});
  }
  return visibilities;
}

PlacementChanges infer_changes(std::span<const AnnotatedPlacement> placements,
                               std::span<const ChangeVisibility> visibilities) {
  require(placements.size() == visibilities.size(), "infer_changes: visibilities must have one entry per placement");
  std::map<std::string, std::vector<SeenPlacement>> by_object;
  for (std::size_t i = 0; i < placements.size(); ++i) {
    const ChangeVisibility& seen = visibilities[i];
    by_object[placements[i].object].push_back(
        {&placements[i], static_cast<int>(i), seen.before_view < 0 ? kNever : seen.before_view, seen.last_free_view});
  }
  PlacementChanges result;
  result.has_left.resize(placements.size(), 0);
  for (auto& [object, of_object] : by_object) {
    link_copies(of_object);
    add_changes(of_object, result);
  }
  std::ranges::stable_sort(result.changes, {}, &TrueChange::view);
  return result;
}

}  // namespace resight
