// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "resight/core/random.hpp"
#include "resight/verification/selection_cost.hpp"
#include "resight/verification/selection_search.hpp"

namespace resight {
namespace {

// Random cues: each candidate explains and clutters a stretch of scene points around a random centre.
struct RandomCues {
  RandomCues(int num_candidates, int num_scene_points, int stretch, std::uint64_t seed) {
    Rng rng(seed);
    for (int c = 0; c < num_candidates; ++c) {
      HypothesisCues h;
      const int first = static_cast<int>(rng.below(static_cast<std::uint32_t>(num_scene_points - stretch)));
      for (int q = first; q < first + stretch; ++q) {
        const double kind = rng.uniform();
        if (kind < 0.6)
          h.explained.push_back({q, static_cast<float>(rng.uniform(0.05, 1))});
        else if (kind < 0.8)
          h.clutter.push_back({q, static_cast<float>(rng.uniform(0.05, 1))});
      }
      h.evidence.costs.outlier = rng.uniform(0, 0.3 * stretch);
      h.evidence.costs.plane = rng.uniform(0, 0.05 * stretch);
      h.evidence.score = rng.uniform();
      cues.push_back(std::move(h));
    }
    for (int a = 0; a < num_candidates; ++a)
      for (int b = a + 1; b < num_candidates; ++b)
        if (rng.uniform() < 0.1) voxels.push_back({a, b, static_cast<int>(rng.below(20)) + 1});
    for (const HypothesisCues& c : cues) pointers.push_back(&c);
  }
  std::vector<HypothesisCues> cues;
  std::vector<const HypothesisCues*> pointers;
  std::vector<SharedVoxels> voxels;
};

// The objective as written down, from scratch, in floating point and per scene point.
double slow_cost(const RandomCues& random, const std::vector<std::uint8_t>& active, const SelectionOptions& options) {
  std::map<int, std::vector<double>> explained;
  std::map<int, double> clutter;
  double cost = 0;
  for (std::size_t c = 0; c < random.cues.size(); ++c) {
    if (active[c] == 0) continue;
    cost += random.cues[c].evidence.costs.outlier + random.cues[c].evidence.costs.plane;
    const double trust = std::pow(random.cues[c].evidence.score, options.score_power);
    for (const WeightedPoint& w : random.cues[c].explained) explained[w.point].push_back(trust * w.weight);
    for (const WeightedPoint& w : random.cues[c].clutter) clutter[w.point] += w.weight;
  }
  for (const auto& [point, weights] : explained) {
    double sum = 0;
    for (const double w : weights) sum += w;
    const double best = *std::max_element(weights.begin(), weights.end());
    cost -= best;
    if (weights.size() > 1)
      cost += options.duplicity_weight * (options.duplicity_rule == DuplicityRule::kAllWeights ? sum : sum - best);
    clutter.erase(point);
  }
  for (const auto& [point, weight] : clutter) cost += weight;
  for (const SharedVoxels& pair : random.voxels)
    if (active[pair.a] != 0 && active[pair.b] != 0) cost += options.occupancy_weight * pair.count;
  return cost;
}

// The exact reference in whole numbers, from the problem itself.
FixedCost cost_from_scratch(const SelectionProblem& problem, const std::vector<std::uint8_t>& active) {
  Selection fresh(problem);
  for (int c = 0; c < problem.num_candidates(); ++c)
    if (active[c] != 0) fresh.switch_candidate(c);
  return fresh.cost();
}

TEST(Selection, CostKeptUpToDateIsTheCostFromScratch) {
  for (const DuplicityRule rule : {DuplicityRule::kBeyondBest, DuplicityRule::kAllWeights}) {
    const SelectionOptions options{.duplicity_weight = 0.75,
                                   .duplicity_rule = rule,
                                   .occupancy_weight = 1.5,
                                   .score_power = rule == DuplicityRule::kBeyondBest ? 0.5 : 0};
    const RandomCues random(15, 600, 150, 7);
    const SelectionProblem problem = make_selection_problem(random.pointers, random.voxels, options);
    ASSERT_GT(problem.num_points, 300);
    Selection selection(problem);
    EXPECT_EQ(selection.cost(), 0);
    Rng rng(1);
    for (int move = 0; move < 2000; ++move) {
      const int c = static_cast<int>(rng.below(15));
      const FixedCost before = selection.cost();
      const FixedCost change = selection.change_if_switched(c);
      EXPECT_EQ(selection.cost(), before);
      selection.switch_candidate(c);
      ASSERT_EQ(selection.cost(), before + change);
      ASSERT_NEAR(from_fixed(selection.cost()), slow_cost(random, selection.active(), options), 0.05);
      if (move % 100 == 0) {
        ASSERT_EQ(selection.cost(), cost_from_scratch(problem, selection.active()));
      }
    }
    for (int c = 0; c < 15; ++c)
      if (selection.is_active(c)) selection.switch_candidate(c);
    EXPECT_EQ(selection.cost(), 0);
  }
}

TEST(Selection, ManyLargeWeightsOfClutterAddUp) {
  RandomCues random(4, 2, 1, 1);
  for (HypothesisCues& h : random.cues) {
    h.explained.clear();
    h.clutter = {{0, 20000.0F}};
  }
  random.voxels.clear();
  const SelectionOptions options;
  const SelectionProblem problem = make_selection_problem(random.pointers, random.voxels, options);
  Selection selection(problem);
  for (int c = 0; c < 4; ++c) selection.switch_candidate(c);
  EXPECT_NEAR(from_fixed(selection.cost()), slow_cost(random, selection.active(), options), 0.05);
  random.cues[0].clutter = {{0, 1e6F}};
  EXPECT_GT(make_selection_problem(random.pointers, random.voxels, options).weights[0].at(0).clutter, 2000000000);
}

// Minimum over all sets.
FixedCost minimum(const SelectionProblem& problem) {
  FixedCost best = 0;
  std::vector<std::uint8_t> active(static_cast<std::size_t>(problem.num_candidates()));
  for (unsigned set = 0; set < (1U << active.size()); ++set) {
    for (std::size_t c = 0; c < active.size(); ++c) active[c] = (set >> c) & 1U;
    best = std::min(best, cost_from_scratch(problem, active));
  }
  return best;
}

TEST(Selection, TheMoreLikelyOfTwoStaysIfItExplainsNearlyAsMuch) {
  std::vector<HypothesisCues> cues(2);
  for (int q = 0; q < 100; ++q) cues[0].explained.push_back({q, 1});
  for (int q = 0; q < 95; ++q) cues[1].explained.push_back({q, 1});
  cues[0].evidence.score = 0.5;
  cues[1].evidence.score = 0.9;
  const std::vector<const HypothesisCues*> pointers{&cues[0], &cues[1]};
  const std::vector<SharedVoxels> same_place{{0, 1, 100}};
  const auto chosen = [&](double score_power) {
    const SelectionOptions options{.score_power = score_power};
    return search_selection(make_selection_problem(pointers, same_place, options), options).active;
  };
  EXPECT_EQ(chosen(0), (std::vector<std::uint8_t>{1, 0}));
  EXPECT_EQ(chosen(0.5), (std::vector<std::uint8_t>{0, 1}));
}

TEST(SearchSelection, FindsTheMinimumOfSmallProblems) {
  int num_local_optimal = 0;
  int num_with_choice = 0;
  for (std::uint64_t seed = 0; seed < 30; ++seed) {
    const RandomCues random(9, 300, 80, seed);
    const SelectionProblem problem = make_selection_problem(random.pointers, random.voxels, {});
    const FixedCost best = minimum(problem);
    const SearchSelectionResult exact = search_selection(problem);
    const SearchSelectionResult local = search_selection(problem, {.max_exact_hypotheses = 0});
    EXPECT_TRUE(exact.is_optimal);
    EXPECT_EQ(exact.cost, best);
    EXPECT_EQ(cost_from_scratch(problem, exact.active), exact.cost);
    EXPECT_GE(local.cost, exact.cost);
    EXPECT_EQ(cost_from_scratch(problem, local.active), local.cost);
    EXPECT_LE(from_fixed(local.cost), 0.9 * from_fixed(best));
    if (local.cost == best) ++num_local_optimal;
    if (best < 0) ++num_with_choice;
  }
  EXPECT_EQ(num_with_choice, 30);
  EXPECT_GE(num_local_optimal, 25);
}

TEST(SearchSelection, LocalSearchEndsWhereNoSwitchHelps) {
  const RandomCues random(60, 1500, 150, 4);
  const SelectionProblem problem = make_selection_problem(random.pointers, random.voxels, {});
  const SearchSelectionResult found = search_selection(problem);
  EXPECT_FALSE(found.is_optimal);
  EXPECT_GT(found.num_moves, 5);
  Selection selection(problem);
  for (int c = 0; c < 60; ++c)
    if (found.active[c] != 0) selection.switch_candidate(c);
  EXPECT_EQ(selection.cost(), found.cost);
  for (int c = 0; c < 60; ++c) EXPECT_GE(selection.change_if_switched(c), 0);
  const SearchSelectionResult again = search_selection(problem);
  EXPECT_EQ(again.active, found.active);
  EXPECT_EQ(search_selection(problem, {.max_moves = 0}).cost, 0);
}

TEST(SearchSelection, ComponentsAreIndependent) {
  // Three clusters far apart: the cost of the union is the sum of the costs alone.
  FixedCost sum = 0;
  RandomCues all(0, 10, 1, 0);
  std::vector<RandomCues> parts;
  for (std::uint64_t seed = 0; seed < 3; ++seed) {
    parts.emplace_back(7, 200, 100, 100 + seed);
    const int offset = static_cast<int>(all.cues.size());
    for (HypothesisCues cues : parts.back().cues) {
      for (WeightedPoint& w : cues.explained) w.point += 1000 * static_cast<int>(seed);
      for (WeightedPoint& w : cues.clutter) w.point += 1000 * static_cast<int>(seed);
      all.cues.push_back(std::move(cues));
    }
    for (const SharedVoxels& pair : parts.back().voxels)
      all.voxels.push_back({pair.a + offset, pair.b + offset, pair.count});
    std::vector<const HypothesisCues*> pointers;
    for (const HypothesisCues& cues : parts.back().cues) pointers.push_back(&cues);
    sum += search_selection(make_selection_problem(pointers, parts.back().voxels, {})).cost;
  }
  for (const HypothesisCues& cues : all.cues) all.pointers.push_back(&cues);
  const SelectionProblem problem = make_selection_problem(all.pointers, all.voxels, {});
  const SearchSelectionResult found = search_selection(problem);
  EXPECT_EQ(found.num_components, 3);
  EXPECT_TRUE(found.is_optimal);
  EXPECT_EQ(found.cost, sum);
  EXPECT_LT(sum, 0);
}

TEST(SearchSelection, TakesNothingWhenNothingPaysOff) {
  HypothesisCues costly;
  costly.explained = {{3, 1.0F}};
  costly.evidence.costs.outlier = 1.5;
  const std::vector<const HypothesisCues*> one = {&costly};
  const SearchSelectionResult found = search_selection(make_selection_problem(one, {}, {}));
  EXPECT_EQ(found.active, std::vector<std::uint8_t>{0});
  EXPECT_EQ(found.cost, 0);
  EXPECT_EQ(search_selection(make_selection_problem({}, {}, {})).num_components, 0);
  EXPECT_THROW((void)search_selection({}, {.max_exact_hypotheses = 21}), std::invalid_argument);
}

}  // namespace
}  // namespace resight
