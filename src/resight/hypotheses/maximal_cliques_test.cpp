// SPDX-License-Identifier: Apache-2.0
#include "resight/hypotheses/maximal_cliques.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <stdexcept>

#include "resight/hypotheses/testing/synthetic_correspondences.hpp"

namespace resight {
namespace {

BitGraph random_graph(Rng& rng, int n, double density) {
  BitGraph graph(n);
  for (int i = 0; i < n; ++i)
    for (int j = i + 1; j < n; ++j)
      if (rng.uniform() < density) graph.add_edge(i, j);
  return graph;
}

std::size_t count_edges(const BitGraph& graph) {
  std::size_t twice = 0;
  for (int v = 0; v < graph.num_vertices(); ++v) twice += static_cast<std::size_t>(graph.degree(v));
  return twice / 2;
}

bool is_clique(const BitGraph& graph, const std::vector<int>& vertices) {
  for (std::size_t i = 0; i < vertices.size(); ++i)
    for (std::size_t j = i + 1; j < vertices.size(); ++j)
      if (!graph.has_edge(vertices[i], vertices[j])) return false;
  return true;
}

// All maximal cliques, by testing every set of vertices.
std::vector<std::vector<int>> all_maximal_cliques(const BitGraph& graph, int min_size) {
  const int n = graph.num_vertices();
  std::vector<std::vector<int>> cliques;
  for (unsigned set = 1; set < 1U << static_cast<unsigned>(n); ++set) {
    std::vector<int> vertices;
    for (int v = 0; v < n; ++v)
      if ((set >> static_cast<unsigned>(v) & 1U) != 0) vertices.push_back(v);
    if (static_cast<int>(vertices.size()) < min_size || !is_clique(graph, vertices)) continue;
    bool maximal = true;
    for (int v = 0; v < n && maximal; ++v)
      maximal = (set >> static_cast<unsigned>(v) & 1U) != 0 ||
                !std::all_of(vertices.begin(), vertices.end(), [&](int u) { return graph.has_edge(u, v); });
    if (maximal) cliques.push_back(vertices);
  }
  std::sort(cliques.begin(), cliques.end(),
            [](const auto& a, const auto& b) { return a.size() != b.size() ? a.size() > b.size() : a < b; });
  return cliques;
}

TEST(FindCliques, EqualsTheSearchOverAllSets) {
  Rng rng(21);
  std::size_t num_found = 0;
  for (int trial = 0; trial < 60; ++trial) {
    const BitGraph graph = random_graph(rng, 4 + trial % 10, 0.3 + 0.1 * (trial % 7));
    const int min_size = 1 + trial % 4;
    const FindCliquesResult result = find_cliques(graph, {.min_size = min_size});
    EXPECT_TRUE(result.complete);
    EXPECT_EQ(result.cliques, all_maximal_cliques(graph, min_size)) << trial;
    num_found += result.cliques.size();
  }
  EXPECT_GT(num_found, 300U);
}

// Bron and Kerbosch as first published: no pivot, no order, no pruning.
void bron_kerbosch(const BitGraph& graph, std::vector<int>& clique, std::vector<int> candidates,
                   std::vector<int> excluded, std::set<std::vector<int>>& cliques) {
  if (candidates.empty() && excluded.empty()) {
    std::vector<int> sorted = clique;
    std::sort(sorted.begin(), sorted.end());
    cliques.insert(sorted);
  }
  const auto neighbors_in = [&](int v, const std::vector<int>& set) {
    std::vector<int> result;
    for (const int u : set)
      if (u != v && graph.has_edge(u, v)) result.push_back(u);
    return result;
  };
  while (!candidates.empty()) {
    const int v = candidates.back();
    clique.push_back(v);
    bron_kerbosch(graph, clique, neighbors_in(v, candidates), neighbors_in(v, excluded), cliques);
    clique.pop_back();
    candidates.pop_back();
    excluded.push_back(v);
  }
}

TEST(FindCliques, EqualsTheSimpleRecursionOnLargerGraphs) {
  Rng rng(28);
  for (const double density : {0.3, 0.5, 0.7}) {
    const BitGraph graph = random_graph(rng, density < 0.6 ? 70 : 35, density);
    std::vector<int> all;
    for (int v = 0; v < graph.num_vertices(); ++v) all.push_back(v);
    std::vector<int> clique;
    std::set<std::vector<int>> expected;
    bron_kerbosch(graph, clique, all, {}, expected);
    ASSERT_GT(expected.size(), 200U);
    const FindCliquesResult result = find_cliques(graph, {.min_size = 1, .max_steps = 1000000});
    EXPECT_TRUE(result.complete);
    EXPECT_EQ(std::set<std::vector<int>>(result.cliques.begin(), result.cliques.end()), expected);
    EXPECT_EQ(result.cliques.size(), expected.size());
  }
}

TEST(FindCliques, FindsPlantedCliquesAcrossWordBoundaries) {
  Rng rng(22);
  BitGraph graph = random_graph(rng, 200, 0.05);
  std::vector<int> planted;
  for (int v = 3; v < 200; v += 17) planted.push_back(v);
  for (const int a : planted)
    for (const int b : planted)
      if (a != b) graph.add_edge(a, b);
  const FindCliquesResult result = find_cliques(graph);
  EXPECT_TRUE(result.complete);
  ASSERT_FALSE(result.cliques.empty());
  EXPECT_EQ(result.cliques.front(), planted);
}

TEST(FindCliques, BudgetIsKeptAndTheGreedyAnswerStillHoldsTheLargeClique) {
  Rng rng(23);
  BitGraph graph = random_graph(rng, 300, 0.3);
  std::vector<int> planted;
  for (int v = 0; v < 30; ++v) planted.push_back(10 * v);
  for (const int a : planted)
    for (const int b : planted)
      if (a != b) graph.add_edge(a, b);
  for (const int budget : {0, 1, 100}) {
    const FindCliquesResult result = find_cliques(graph, {.max_steps = budget});
    EXPECT_FALSE(result.complete);
    EXPECT_LE(result.num_steps, budget);
    ASSERT_FALSE(result.cliques.empty());
    for (const auto& clique : result.cliques) EXPECT_TRUE(is_clique(graph, clique));
    EXPECT_TRUE(
        std::includes(result.cliques.front().begin(), result.cliques.front().end(), planted.begin(), planted.end()));
  }
}

TEST(FindCliques, EmptyGraphsHaveNone) {
  EXPECT_TRUE(find_cliques(BitGraph(0)).cliques.empty());
  EXPECT_TRUE(find_cliques(BitGraph(70)).cliques.empty());
  EXPECT_THROW((void)find_cliques(BitGraph(3), {.min_size = 0}), std::invalid_argument);
  EXPECT_THROW((void)find_cliques(BitGraph(3), {.max_steps = -1}), std::invalid_argument);
}

TEST(DegeneracyOrder, EqualsPeelingByHand) {
  Rng rng(24);
  for (int trial = 0; trial < 30; ++trial) {
    const int n = 20 + 10 * (trial % 8);
    const BitGraph graph = random_graph(rng, n, 0.05 + 0.03 * (trial % 5));
    const Degeneracy degeneracy = degeneracy_order(graph);
    ASSERT_EQ(degeneracy.order.size(), static_cast<std::size_t>(n));
    std::vector<bool> peeled(static_cast<std::size_t>(n), false);
    int core = 0;
    for (const int v : degeneracy.order) {
      const auto remaining_degree = [&](int a) {
        int degree = 0;
        for (int b = 0; b < n; ++b) degree += !peeled[static_cast<std::size_t>(b)] && b != a && graph.has_edge(a, b);
        return degree;
      };
      for (int u = 0; u < n; ++u)
        if (!peeled[static_cast<std::size_t>(u)]) {
          EXPECT_GE(remaining_degree(u), remaining_degree(v));
        }
      core = std::max(core, remaining_degree(v));
      EXPECT_EQ(degeneracy.core[static_cast<std::size_t>(v)], core);
      peeled[static_cast<std::size_t>(v)] = true;
    }
    EXPECT_GT(core, 0);
  }
}

// The definition of an edge, implemented literally.
bool consistent(const Correspondence& a, const Correspondence& b, const ConsistencyOptions& options) {
  if (a.type == b.type && (a.model_feature == b.model_feature || a.scene_feature == b.scene_feature)) return false;
  const double model_m = (a.model_point - b.model_point).cast<double>().norm();
  const double scene_m = (a.scene_point - b.scene_point).cast<double>().norm();
  if (model_m < options.min_distance_m || scene_m < options.min_distance_m) return false;
  if (std::abs(model_m - scene_m) >= options.max_distance_difference_m) return false;
  const double dots = std::abs(a.model_normal.dot(b.model_normal) - a.scene_normal.dot(b.scene_normal));
  return !(dots > options.max_dot_difference);
}

TEST(ConsistencyGraph, EqualsTheDefinition) {
  testing::Problem problem =
      testing::make_problem({.num_correspondences = 190, .inliers_per_instance = 40, .num_instances = 2, .seed = 25});
  auto& c = problem.correspondences;
  for (std::size_t i = 0; i < c.size(); i += 9) c[i].model_feature = c[0].model_feature;
  for (std::size_t i = 1; i < c.size(); i += 7) c[i].scene_feature = c[1].scene_feature;
  for (std::size_t i = 0; i < c.size(); i += 4) c[i].type = FeatureType::kShot;
  for (std::size_t i = 2; i < c.size(); i += 31) c[i].scene_normal.setConstant(std::numeric_limits<float>::quiet_NaN());
  const ConsistencyOptions options;
  const BitGraph graph = build_consistency_graph(c, options);
  ASSERT_EQ(graph.num_vertices(), 190);
  std::size_t num_edges = 0;
  for (int i = 0; i < 190; ++i) {
    EXPECT_FALSE(graph.has_edge(i, i));
    for (int j = 0; j < 190; ++j) {
      if (i == j) continue;
      const bool expected = consistent(c[static_cast<std::size_t>(i)], c[static_cast<std::size_t>(j)], options);
      EXPECT_EQ(graph.has_edge(i, j), expected) << i << " " << j;
      num_edges += expected ? 1 : 0;
    }
  }
  EXPECT_GT(num_edges, 1000U);
  EXPECT_EQ(count_edges(graph) * 2, num_edges);
}

TEST(ConsistencyGraph, UnknownFeaturesAreSharedWithNone) {
  testing::Problem problem =
      testing::make_problem({.num_correspondences = 10, .inliers_per_instance = 10, .noise_m = 0, .seed = 26});
  const std::size_t num_edges = count_edges(build_consistency_graph(problem.correspondences, {}));
  EXPECT_GT(num_edges, 20U);
  for (auto& c : problem.correspondences) c.model_feature = c.scene_feature = -1;
  EXPECT_EQ(count_edges(build_consistency_graph(problem.correspondences, {})), num_edges);
}

TEST(BitGraph, SubgraphKeepsTheEdges) {
  Rng rng(27);
  const BitGraph graph = random_graph(rng, 130, 0.2);
  std::vector<int> vertices;
  for (int v = 129; v >= 0; v -= 2) vertices.push_back(v);
  const BitGraph sub = graph.subgraph(vertices);
  ASSERT_GT(count_edges(sub), 50U);
  for (std::size_t i = 0; i < vertices.size(); ++i)
    for (std::size_t j = 0; j < vertices.size(); ++j)
      if (i != j) {
        EXPECT_EQ(sub.has_edge(static_cast<int>(i), static_cast<int>(j)), graph.has_edge(vertices[i], vertices[j]));
      }
}

}  // namespace
}  // namespace resight
