// SPDX-License-Identifier: Apache-2.0
#include "resight/sensor/depth_edges.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <stdexcept>

#include "resight/sensor/sensor_test_scenes.hpp"

namespace resight {
namespace {

using test::kNan;

Image<std::uint8_t> edges_by_definition(const Image<float>& depth, float max_jump) {
  Image<std::uint8_t> edges(depth.width(), depth.height());
  for (int v = 0; v < depth.height(); ++v)
    for (int u = 0; u < depth.width(); ++u)
      for (int dv = -1; dv <= 1; ++dv)
        for (int du = -1; du <= 1; ++du) {
          if (std::isnan(depth(u, v)) || !depth.contains(u + du, v + dv)) continue;
          const float a = depth(u, v);
          const float b = depth(u + du, v + dv);
          if (std::isnan(b) || std::abs(a - b) > max_jump * std::min(a, b)) edges(u, v) = 1;
        }
  return edges;
}

double distance_by_definition(const Image<std::uint8_t>& edges, int u, int v, double cap) {
  double best_sq = cap * cap;
  for (int y = 0; y < edges.height(); ++y)
    for (int x = 0; x < edges.width(); ++x)
      if (edges(x, y) != 0) best_sq = std::min<double>(best_sq, (x - u) * (x - u) + (y - v) * (y - v));
  return std::sqrt(best_sq);
}

TEST(FindDepthEdges, AgreesWithTheDefinition) {
  const Image<float> depth = test::render_noisy_sphere(test::small_camera(), 11);
  const Image<std::uint8_t> edges = find_depth_edges(depth, {.max_depth_jump = 0.05});
  EXPECT_EQ(edges, edges_by_definition(depth, 0.05F));
  EXPECT_GT(std::ranges::count(edges.data(), 1), 1000);
  EXPECT_GT(std::ranges::count(edges.data(), 0), 1000);
}

TEST(FindDepthEdges, MarksBothSidesOfAStepButNotTheImageBorder) {
  Image<float> depth(20, 10, 1.0F);
  for (int v = 0; v < 10; ++v)
    for (int u = 12; u < 20; ++u) depth(u, v) = 1.06F;
  const Image<std::uint8_t> edges = find_depth_edges(depth);
  for (int v = 0; v < 10; ++v)
    for (int u = 0; u < 20; ++u) EXPECT_EQ(edges(u, v), u == 11 || u == 12 ? 1 : 0) << u << ", " << v;
  EXPECT_EQ(std::ranges::count(find_depth_edges(depth, {.max_depth_jump = 0.07}).data(), 1), 0);
}

TEST(FindDepthEdges, MarksTheRimOfAHole) {
  Image<float> depth(9, 9, 1.0F);
  depth(4, 4) = kNan;
  const Image<std::uint8_t> edges = find_depth_edges(depth);
  EXPECT_EQ(std::ranges::count(edges.data(), 1), 8);
  EXPECT_EQ(edges(4, 4), 0);
  EXPECT_EQ(edges(3, 3), 1);
  EXPECT_TRUE(find_depth_edges(Image<float>()).empty());
}

TEST(FindEdgeDistance, AgreesWithTheDefinition) {
  Rng rng(3);
  for (const double density : {0.0, 0.0005, 0.01, 0.3}) {
    Image<std::uint8_t> edges(61, 43);
    for (auto& edge : edges.data()) edge = rng.uniform() < density ? 1 : 0;
    for (const double cap : {0.5, 1.0, 3.7, 5.0, 30.0, 500.0}) {
      const Image<float> distance = find_edge_distance(edges, cap);
      for (int v = 0; v < edges.height(); ++v)
        for (int u = 0; u < edges.width(); ++u)
          ASSERT_NEAR(distance(u, v), distance_by_definition(edges, u, v, cap), 1e-4)
              << u << ", " << v << " cap " << cap;
    }
  }
}

TEST(FindEdgeDistance, IsTheCapWithoutEdges) {
  const Image<float> distance = find_edge_distance(Image<std::uint8_t>(7, 5), std::numeric_limits<double>::infinity());
  for (const float d : distance.data()) EXPECT_TRUE(std::isinf(d));
  EXPECT_TRUE(find_edge_distance(Image<std::uint8_t>(), 5).empty());
}

TEST(DepthEdges, RefuseBadOptions) {
  const Image<float> depth(5, 5, 1.0F);
  EXPECT_THROW((void)find_depth_edges(depth, {.max_depth_jump = 0}), std::invalid_argument);
  EXPECT_THROW((void)find_depth_edges(depth, {.max_distance_px = kNan}), std::invalid_argument);
  EXPECT_THROW((void)find_edge_distance(Image<std::uint8_t>(5, 5), 0), std::invalid_argument);
}

}  // namespace
}  // namespace resight
