// SPDX-License-Identifier: Apache-2.0
#include "resight/sensor/depth_edges.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <stdexcept>
#include <utility>

#include "resight/core/random.hpp"
#include "resight/sensor/sensor_test_scenes.hpp"

namespace resight {
namespace {

using test::kNan;

bool is_missing(const Image<float>& depth, int u, int v) { return !depth.contains(u, v) || std::isnan(depth(u, v)); }
bool is_step(float a, float b, float max_jump) { return std::abs(a - b) > max_jump * std::min(a, b); }

/// Follows runs of missing pixels from each measurement in each direction, and fills those that end at a similar depth.
Image<float> bridged_by_definition(const Image<float>& depth, float max_jump, int max_gap) {
  Image<float> bridged = depth;
  // The last direction takes precedence: rows first.
  for (const auto& [du, dv] : {std::pair{1, -1}, {1, 1}, {0, 1}, {1, 0}})
    for (int v = 0; v < depth.height(); ++v)
      for (int u = 0; u < depth.width(); ++u) {
        if (is_missing(depth, u, v)) continue;
        int gap = 0;
        while (gap <= max_gap && is_missing(depth, u + (gap + 1) * du, v + (gap + 1) * dv)) ++gap;
        if (gap == 0 || gap > max_gap) continue;
        const float end = depth(u + (gap + 1) * du, v + (gap + 1) * dv);
        if (is_step(depth(u, v), end, max_jump)) continue;
        for (int i = 1; i <= gap; ++i) bridged(u + i * du, v + i * dv) = (depth(u, v) + end) / 2;
      }
  return bridged;
}

Image<std::uint8_t> edges_by_definition(const Image<float>& depth, float max_jump, int max_gap) {
  const Image<float> bridged = bridged_by_definition(depth, max_jump, max_gap);
  Image<std::uint8_t> edges(depth.width(), depth.height());
  for (int v = 0; v < depth.height(); ++v)
    for (int u = 0; u < depth.width(); ++u)
      for (int y = v - 1; y <= v + 1; ++y)
        for (int x = u - 1; x <= u + 1; ++x)
          if (!std::isnan(depth(u, v)) && depth.contains(x, y) &&
              (std::isnan(bridged(x, y)) || is_step(depth(u, v), bridged(x, y), max_jump)))
            edges(u, v) = 1;
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
  Image<float> depth = test::render_noisy_sphere(test::small_camera(), 11);
  for (int v = 20; v < 30; ++v)
    for (int u = 0; u < 40; ++u) depth(u, v) = kNan;
  long num_before = 0;
  for (const int max_gap : {4, 2, 1, 0}) {
    const Image<std::uint8_t> edges = find_depth_edges(depth, {.max_depth_jump = 0.05, .max_gap_px = max_gap});
    EXPECT_EQ(edges, edges_by_definition(depth, 0.05F, max_gap));
    const auto num_edges = std::ranges::count(edges.data(), 1);
    EXPECT_GT(num_edges, num_before);  // the fewer gaps are bridged, the more edges remain
    EXPECT_GT(std::ranges::count(edges.data(), 0), 1000);
    num_before = num_edges;
  }
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

TEST(FindDepthEdges, MarksTheRimOfAHoleUnlessItIsAGapInASurface) {
  Image<float> depth(9, 9, 1.0F);
  depth(4, 4) = kNan;
  EXPECT_EQ(std::ranges::count(find_depth_edges(depth, {.max_gap_px = 1}).data(), 1), 0);
  const Image<std::uint8_t> edges = find_depth_edges(depth, {.max_gap_px = 0});
  EXPECT_EQ(std::ranges::count(edges.data(), 1), 8);
  EXPECT_EQ(edges(4, 4), 0);
  EXPECT_EQ(edges(3, 3), 1);
  for (int v = 0; v < 9; ++v) {  // a gap between two surfaces at different depths
    depth(4, v) = kNan;
    for (int u = 5; u < 9; ++u) depth(u, v) = 1.5F;
  }
  const Image<std::uint8_t> step = find_depth_edges(depth);
  for (int v = 0; v < 9; ++v)
    for (int u = 0; u < 9; ++u) EXPECT_EQ(step(u, v), u == 3 || u == 5 ? 1 : 0) << u << ", " << v;
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

TEST(UpdateEdgeDistance, IsThatOfTheChangedDepth) {
  const Camera camera{320, 240, 262.5, 262.5, 159.5, 119.5};
  const Image<float> depth = test::render_noisy_sphere(camera, 7);
  for (const DepthEdgeOptions& options :
       {DepthEdgeOptions{}, DepthEdgeOptions{.max_gap_px = 0, .max_distance_px = 2.5},
        DepthEdgeOptions{.max_depth_jump = 0.01, .max_gap_px = 4, .max_distance_px = 500}}) {
    Rng rng(2);
    for (const int num_patches : {0, 1, 4, 200}) {
      Image<float> changed = depth;
      std::vector<int> pixels;
      for (int patch = 0; patch < num_patches; ++patch) {
        const int u = static_cast<int>(rng.below(316));
        const int v = static_cast<int>(rng.below(236));
        for (int k = 0; k < 16; ++k) {
          pixels.push_back(static_cast<int>(changed.index(u + k % 4, v + k / 4)));
          changed(u + k % 4, v + k / 4) = kNan;
        }
      }
      Image<float> distance = find_edge_distance(find_depth_edges(depth, options), options.max_distance_px);
      update_edge_distance(changed, pixels, options, distance);
      EXPECT_TRUE(
          test::same_bytes(distance, find_edge_distance(find_depth_edges(changed, options), options.max_distance_px)));
    }
  }
  Image<float> small(3, 3);
  EXPECT_THROW(update_edge_distance(depth, {}, {}, small), std::invalid_argument);
}

TEST(DepthEdges, RefuseBadOptions) {
  const Image<float> depth(5, 5, 1.0F);
  EXPECT_THROW((void)find_depth_edges(depth, {.max_depth_jump = 0}), std::invalid_argument);
  EXPECT_THROW((void)find_depth_edges(depth, {.max_gap_px = -1}), std::invalid_argument);
  EXPECT_THROW((void)find_depth_edges(depth, {.max_distance_px = kNan}), std::invalid_argument);
  EXPECT_THROW((void)find_edge_distance(Image<std::uint8_t>(5, 5), 0), std::invalid_argument);
}

}  // namespace
}  // namespace resight
