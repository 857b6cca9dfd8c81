// SPDX-License-Identifier: Apache-2.0
#include "resight/verification/selection_search.hpp"

#include <algorithm>
#include <bit>

#include "resight/core/disjoint_sets.hpp"
#include "resight/core/random.hpp"

namespace resight {
namespace {

// Replace moves are tried for pairs that both explain more points than this (V4R: 10), or that conflict.
constexpr int kMinSharedPoints = 10;

// Switches `remove` off (unless -1) and `add` on (unless -1); a flip has one of them.
struct Move {
  int remove = -1;
  int add = -1;
};

// The members that explain each point.
std::vector<std::vector<int>> find_explaining_members(const SelectionProblem& problem,
                                                      const std::vector<int>& members) {
  std::vector<std::vector<int>> explaining(static_cast<std::size_t>(problem.num_points));
  for (const int c : members)
    for (const FixedWeight& w : problem.weights[c])
      if (w.explained > 0) explaining[w.point].push_back(c);
  return explaining;
}

std::vector<Move> list_moves(const SelectionProblem& problem, const std::vector<int>& members, int min_shared_points) {
  const std::vector<std::vector<int>> explaining = find_explaining_members(problem, members);
  std::vector<Move> moves;
  for (const int c : members) moves.push_back({-1, c});
  const auto n = static_cast<std::size_t>(problem.num_candidates());
  std::vector<int> num_shared(n);
  std::vector<std::uint8_t> in_conflict(n);
  for (const int a : members) {
    std::ranges::fill(num_shared, 0);
    std::ranges::fill(in_conflict, 0);
    for (const FixedWeight& w : problem.weights[a])
      if (w.explained > 0)
        for (const int c : explaining[w.point]) ++num_shared[c];
    for (const SelectionProblem::Conflict& conflict : problem.conflicts[a]) in_conflict[conflict.other] = 1;
    for (const int b : members)
      if (a != b && (num_shared[b] > min_shared_points || in_conflict[b] != 0)) moves.push_back({a, b});
  }
  return moves;
}

// Makes the move if it lowers the cost.
bool try_move(Selection& selection, const Move& move) {
  if (move.remove < 0) {
    if (selection.change_if_switched(move.add) >= 0) return false;
    selection.switch_candidate(move.add);
    return true;
  }
  if (!selection.is_active(move.remove) || selection.is_active(move.add)) return false;
  const FixedCost before = selection.cost();
  selection.switch_candidate(move.remove);
  if (selection.cost() + selection.change_if_switched(move.add) < before) {
    selection.switch_candidate(move.add);
    return true;
  }
  selection.switch_candidate(move.remove);
  return false;
}

int descend(Selection& selection, std::vector<Move>& moves, int max_moves, Rng& rng) {
  int accepted = 0;
  bool improved = true;
  while (improved && accepted < max_moves) {
    improved = false;
    rng.shuffle(moves);
    for (const Move& move : moves) {
      if (!try_move(selection, move)) continue;
      ++accepted;
      improved = true;
      if (accepted >= max_moves) break;
    }
  }
  return accepted;
}

// Always the candidate that lowers the cost most.
int add_greedily(Selection& selection, const std::vector<int>& members, int max_moves) {
  for (int accepted = 0; accepted < max_moves; ++accepted) {
    int best = -1;
    FixedCost best_change = 0;
    for (const int c : members) {
      if (selection.is_active(c)) continue;
      const FixedCost change = selection.change_if_switched(c);
      if (change >= best_change) continue;
      best_change = change;
      best = c;
    }
    if (best < 0) return accepted;
    selection.switch_candidate(best);
  }
  return max_moves;
}

void switch_off(Selection& selection, const std::vector<int>& members) {
  for (const int c : members)
    if (selection.is_active(c)) selection.switch_candidate(c);
}

void activate(Selection& selection, const std::vector<int>& members, const std::vector<std::uint8_t>& wanted) {
  for (std::size_t m = 0; m < members.size(); ++m)
    if (selection.is_active(members[m]) != (wanted[m] != 0)) selection.switch_candidate(members[m]);
}

std::vector<std::uint8_t> active_of(const Selection& selection, const std::vector<int>& members) {
  std::vector<std::uint8_t> active;
  for (const int c : members) active.push_back(selection.is_active(c) ? 1 : 0);
  return active;
}

void enumerate(Selection& selection, const std::vector<int>& members) {
  FixedCost best_cost = selection.cost();
  std::uint32_t best_set = 0;
  const std::uint32_t num_sets = 1U << members.size();
  for (std::uint32_t step = 1; step < num_sets; ++step) {
    selection.switch_candidate(members[std::countr_zero(step)]);  // Gray code: set number step is step ^ (step >> 1).
    if (selection.cost() >= best_cost) continue;
    best_cost = selection.cost();
    best_set = step ^ (step >> 1U);
  }
  std::vector<std::uint8_t> wanted;
  for (std::size_t m = 0; m < members.size(); ++m) wanted.push_back((best_set >> m) & 1U);
  activate(selection, members, wanted);
}

int search_locally(Selection& selection, const std::vector<int>& members, const SelectionProblem& problem,
                   const SelectionOptions& options, std::uint64_t seed) {
  std::vector<Move> moves = list_moves(problem, members, kMinSharedPoints);
  Rng rng = Rng::stream(seed, static_cast<std::uint64_t>(members.front()));
  int num_moves = descend(selection, moves, options.max_moves, rng);
  const FixedCost cost_from_empty = selection.cost();
  const std::vector<std::uint8_t> from_empty = active_of(selection, members);
  switch_off(selection, members);
  const int greedy_moves = add_greedily(selection, members, options.max_moves);
  num_moves += greedy_moves + descend(selection, moves, options.max_moves - greedy_moves, rng);
  if (cost_from_empty <= selection.cost()) activate(selection, members, from_empty);
  return num_moves;
}

}  // namespace

std::vector<std::vector<int>> find_components(const SelectionProblem& problem) {
  const int n = problem.num_candidates();
  DisjointSets sets(static_cast<std::size_t>(n));
  std::vector<int> first_user(static_cast<std::size_t>(problem.num_points), -1);
  for (int c = 0; c < n; ++c) {
    for (const FixedWeight& w : problem.weights[c]) {
      if (first_user[w.point] < 0)
        first_user[w.point] = c;
      else
        sets.join(first_user[w.point], c);
    }
    for (const SelectionProblem::Conflict& conflict : problem.conflicts[c]) sets.join(c, conflict.other);
  }
  std::vector<std::vector<int>> components;
  std::vector<int> number(static_cast<std::size_t>(n), -1);
  for (int c = 0; c < n; ++c) {
    const int r = sets.root(c);
    if (number[r] < 0) {
      number[r] = static_cast<int>(components.size());
      components.emplace_back();
    }
    components[number[r]].push_back(c);
  }
  return components;
}

SearchSelectionResult search_selection(const SelectionProblem& problem, const SelectionOptions& options,
                                       std::uint64_t seed) {
  options.check();
  SearchSelectionResult result;
  Selection selection(problem);
  for (const std::vector<int>& members : find_components(problem)) {
    ++result.num_components;
    if (static_cast<int>(members.size()) <= std::max(1, options.max_exact_hypotheses)) {
      enumerate(selection, members);
    } else {
      result.is_optimal = false;
      result.num_moves += search_locally(selection, members, problem, options, seed);
    }
  }
  result.active = selection.active();
  result.cost = selection.cost();
  return result;
}

}  // namespace resight
