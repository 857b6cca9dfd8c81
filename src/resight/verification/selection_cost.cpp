// SPDX-License-Identifier: Apache-2.0
#include "resight/verification/selection_cost.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace resight {
namespace {

constexpr double kWeightOne = 65536.0;
constexpr FixedCost kCostPerWeight = 256;  // 2^24 / 2^16

/// Weights beyond the largest integer, some 30,000, count as that.
std::int32_t to_weight(float weight) {
  constexpr double kLargest = std::numeric_limits<std::int32_t>::max();
  return static_cast<std::int32_t>(std::lround(std::min(kLargest, weight * kWeightOne)));
}

std::vector<FixedWeight> merge_weights(const HypothesisCues& cues, double score_power) {
  const auto trust = static_cast<float>(std::pow(cues.evidence.score, score_power));  // 1 for a power of 0.
  std::vector<FixedWeight> merged;
  merged.reserve(cues.explained.size() + cues.clutter.size());
  for (const WeightedPoint& w : cues.explained) merged.push_back({w.point, to_weight(trust * w.weight), 0});
  for (const WeightedPoint& w : cues.clutter) merged.push_back({w.point, 0, to_weight(w.weight)});
  std::sort(merged.begin(), merged.end(), [](const FixedWeight& a, const FixedWeight& b) { return a.point < b.point; });
  return merged;
}

}  // namespace

double own_cost(const HypothesisEvidence& evidence) { return evidence.costs.outlier + evidence.costs.plane; }

double unary_cost(const HypothesisEvidence& evidence) {
  return own_cost(evidence) + evidence.costs.clutter - evidence.costs.explained_scene;
}

FixedCost to_fixed(double cost) { return std::llround(cost * kFixedOne); }

SelectionProblem make_selection_problem(std::span<const HypothesisCues* const> candidates,
                                        std::span<const SharedVoxels> shared_voxels, const SelectionOptions& options) {
  SelectionProblem problem;
  problem.duplicity_scale = std::llround(options.duplicity_weight * static_cast<double>(kCostPerWeight));
  problem.duplicity_rule = options.duplicity_rule;
  problem.conflicts.resize(candidates.size());
  int num_scene_points = 0;
  for (const HypothesisCues* cues : candidates) {
    problem.unary.push_back(to_fixed(own_cost(cues->evidence)));
    problem.weights.push_back(merge_weights(*cues, options.score_power));
    if (!problem.weights.back().empty())
      num_scene_points = std::max(num_scene_points, problem.weights.back().back().point + 1);
  }
  std::vector<int> num_users(static_cast<std::size_t>(num_scene_points), 0);
  for (const auto& weights : problem.weights)
    for (const FixedWeight& w : weights) ++num_users[w.point];
  std::vector<int> number(num_users.size(), -1);
  for (std::size_t i = 0; i < num_users.size(); ++i)
    if (num_users[i] > 1) number[i] = problem.num_points++;
  for (std::size_t c = 0; c < candidates.size(); ++c)
    std::erase_if(problem.weights[c], [&](FixedWeight& w) {
      if (number[w.point] < 0) problem.unary[c] += (w.clutter - w.explained) * kCostPerWeight;
      w.point = number[w.point];
      return w.point < 0;
    });
  for (const SharedVoxels& pair : shared_voxels) {
    const FixedCost cost = to_fixed(options.occupancy_weight * pair.count);
    problem.conflicts[pair.a].push_back({pair.b, cost});
    problem.conflicts[pair.b].push_back({pair.a, cost});
  }
  return problem;
}

Selection::Selection(const SelectionProblem& problem)
    : problem_(problem),
      active_(problem.unary.size(), 0),
      points_(static_cast<std::size_t>(problem.num_points)),
      explainer_begin_(static_cast<std::size_t>(problem.num_points) + 1, 0) {
  for (const auto& weights : problem.weights)
    for (const FixedWeight& w : weights)
      if (w.explained > 0) ++explainer_begin_[w.point + 1];
  for (std::size_t i = 1; i < explainer_begin_.size(); ++i) explainer_begin_[i] += explainer_begin_[i - 1];
  explainers_.resize(static_cast<std::size_t>(explainer_begin_.back()));
  std::vector<int> next(explainer_begin_.begin(), explainer_begin_.end() - 1);
  for (int c = 0; c < problem.num_candidates(); ++c)
    for (const FixedWeight& w : problem.weights[c])
      if (w.explained > 0) explainers_[next[w.point]++] = {c, w.explained};
}

FixedCost Selection::point_cost(const PointState& state) const {
  if (state.num_explaining == 0) return state.clutter * kCostPerWeight;
  FixedCost duplicity = 0;
  if (state.num_explaining > 1)
    duplicity = problem_.duplicity_rule == DuplicityRule::kAllWeights ? state.sum : state.sum - state.best;
  return duplicity * problem_.duplicity_scale - state.best * kCostPerWeight;
}

std::int32_t Selection::best_without(int point, int candidate) const {
  std::int32_t best = 0;
  for (int i = explainer_begin_[point]; i < explainer_begin_[point + 1]; ++i)
    if (explainers_[i].candidate != candidate && active_[explainers_[i].candidate] != 0)
      best = std::max(best, explainers_[i].weight);
  return best;
}

Selection::PointState Selection::switched(const FixedWeight& weight, int candidate, bool activate) const {
  PointState state = points_[weight.point];
  const int sign = activate ? 1 : -1;
  state.clutter += sign * weight.clutter;
  if (weight.explained == 0) return state;
  state.num_explaining += sign;
  state.sum += sign * weight.explained;
  if (activate)
    state.best = std::max(state.best, weight.explained);
  else if (state.best == weight.explained)
    state.best = best_without(weight.point, candidate);
  return state;
}

FixedCost Selection::unary_change(int candidate) const {
  FixedCost cost = problem_.unary[candidate];
  for (const SelectionProblem::Conflict& conflict : problem_.conflicts[candidate])
    if (active_[conflict.other] != 0) cost += conflict.cost;
  return active_[candidate] != 0 ? -cost : cost;
}

FixedCost Selection::change_if_switched(int candidate) const {
  const bool activate = active_[candidate] == 0;
  FixedCost change = unary_change(candidate);
  for (const FixedWeight& w : problem_.weights[candidate])
    change += point_cost(switched(w, candidate, activate)) - point_cost(points_[w.point]);
  return change;
}

void Selection::switch_candidate(int candidate) {
  const bool activate = active_[candidate] == 0;
  cost_ += unary_change(candidate);
  for (const FixedWeight& w : problem_.weights[candidate]) {
    const PointState state = switched(w, candidate, activate);
    cost_ += point_cost(state) - point_cost(points_[w.point]);
    points_[w.point] = state;
  }
  active_[candidate] = activate ? 1 : 0;
}

}  // namespace resight
