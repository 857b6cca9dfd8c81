// SPDX-License-Identifier: Apache-2.0
#include "resight/evaluation/assignment.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <stdexcept>

#include "resight/core/random.hpp"

namespace resight {
namespace {

constexpr double kForbidden = std::numeric_limits<double>::quiet_NaN();

struct Quality {
  int pairs = 0;
  double cost = 0;
  [[nodiscard]] bool better_than(const Quality& other) const {
    return pairs != other.pairs ? pairs > other.pairs : cost < other.cost;
  }
};

/// Reference implementation: tries all assignments of columns, row by row.
Quality best_by_trying(const std::vector<double>& cost, int rows, int columns, int row, std::vector<char>& taken) {
  if (row == rows) return {};
  Quality best = best_by_trying(cost, rows, columns, row + 1, taken);  // This row remains unassigned.
  for (int column = 0; column < columns; ++column) {
    const double value = cost[static_cast<std::size_t>(row * columns + column)];
    if (taken[static_cast<std::size_t>(column)] || std::isnan(value)) continue;
    taken[static_cast<std::size_t>(column)] = 1;
    Quality with = best_by_trying(cost, rows, columns, row + 1, taken);
    taken[static_cast<std::size_t>(column)] = 0;
    with.pairs += 1;
    with.cost += value;
    if (with.better_than(best)) best = with;
  }
  return best;
}

Quality quality_of(const std::vector<int>& column_of_row, const std::vector<double>& cost, int columns) {
  Quality quality;
  std::vector<char> taken(static_cast<std::size_t>(columns), 0);
  for (std::size_t row = 0; row < column_of_row.size(); ++row) {
    const int column = column_of_row[row];
    if (column < 0) continue;
    EXPECT_FALSE(taken[static_cast<std::size_t>(column)]) << "column " << column << " assigned twice";
    taken[static_cast<std::size_t>(column)] = 1;
    const double value = cost[row * static_cast<std::size_t>(columns) + static_cast<std::size_t>(column)];
    EXPECT_FALSE(std::isnan(value)) << "forbidden pair";
    quality.pairs += 1;
    quality.cost += value;
  }
  return quality;
}

TEST(AssignOptimally, EqualsTryingAllAssignments) {
  int cases = 0;
  int with_forbidden_pairs = 0;
  for (std::uint64_t seed = 1; seed <= 400; ++seed) {
    Rng rng(seed);
    const int rows = static_cast<int>(rng.below(6)) + 1;
    const int columns = static_cast<int>(rng.below(6)) + 1;
    std::vector<double> cost;
    for (int i = 0; i < rows * columns; ++i) {
      const bool forbidden = rng.uniform() < 0.4;
      with_forbidden_pairs += forbidden ? 1 : 0;
      cost.push_back(forbidden ? kForbidden : rng.uniform() * 2.0);
    }
    std::vector<char> taken(static_cast<std::size_t>(columns), 0);
    const Quality expected = best_by_trying(cost, rows, columns, 0, taken);
    const Quality actual = quality_of(assign_optimally(cost, rows, columns), cost, columns);
    ASSERT_EQ(actual.pairs, expected.pairs) << "seed " << seed;
    ASSERT_NEAR(actual.cost, expected.cost, 1e-9) << "seed " << seed;
    ++cases;
  }
  EXPECT_EQ(cases, 400);
  EXPECT_GT(with_forbidden_pairs, 500);
}

TEST(AssignOptimally, MorePairsBeatCheaperPairs) {
  // A greedy choice takes 0.1 and leaves the second row unassigned.
  const std::vector<double> cost = {0.1, 1.9, 0.2, kForbidden};
  EXPECT_EQ(assign_optimally(cost, 2, 2), (std::vector<int>{1, 0}));
}

TEST(AssignOptimally, HandlesEmptySides) {
  EXPECT_TRUE(assign_optimally({}, 0, 3).empty());
  EXPECT_EQ(assign_optimally({}, 2, 0), (std::vector<int>{-1, -1}));
}

TEST(AssignOptimally, NeedsNoSquareOfTheLongerSide) {
  constexpr int kMany = 200000;  // Its square would take 300 GB.
  std::vector<double> cost(kMany, 2.0);
  cost[kMany - 7] = 1.0;
  EXPECT_EQ(assign_optimally(cost, 1, kMany), std::vector<int>{kMany - 7});
  EXPECT_EQ(assign_optimally(cost, kMany, 1)[kMany - 7], 0);
}

TEST(AssignOptimally, RefusesBadInput) {
  const std::vector<double> negative = {-1.0};
  const std::vector<double> infinite = {std::numeric_limits<double>::infinity()};
  EXPECT_THROW((void)assign_optimally(negative, 1, 1), std::invalid_argument);
  EXPECT_THROW((void)assign_optimally(infinite, 1, 1), std::invalid_argument);
  EXPECT_THROW((void)assign_optimally(negative, 1, 2), std::invalid_argument);
}

}  // namespace
}  // namespace resight
