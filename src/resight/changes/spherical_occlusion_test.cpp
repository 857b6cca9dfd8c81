// SPDX-License-Identifier: Apache-2.0
#include "resight/changes/spherical_occlusion.hpp"

#include <gtest/gtest.h>

#include <array>
#include <stdexcept>

#include "resight/changes/analytic_scene_test_util.hpp"
#include "resight/core/random.hpp"

namespace resight {
namespace {

using namespace testing_scene;
using Points = std::vector<Eigen::Vector3f>;

/// The slow reference of the z-buffer: every query against every blocker, as the text of Sec. III-B1 goes.
Evidence classify_slowly(const Eigen::Vector3f& query, const Points& blockers, const SphericalBins& bins,
                         float margin_m) {
  Evidence evidence = Evidence::kUnobserved;
  for (const Eigen::Vector3f& blocker : blockers) {
    if (bins.bin(query) < 0 || bins.bin(blocker) != bins.bin(query)) continue;
    if (blocker.norm() < query.norm() - margin_m) return Evidence::kOccluded;
    evidence = Evidence::kSeenThrough;
  }
  return evidence;
}

Points random_points_within(int count, double extent_m, std::uint64_t seed) {
  Rng rng(seed);
  Points points;
  const auto next = [&] { return static_cast<float>(rng.uniform(-extent_m, extent_m)); };
  for (int i = 0; i < count; ++i) points.emplace_back(next(), next(), next());
  return points;
}

std::array<int, 4> count(const std::vector<Evidence>& evidence) {
  std::array<int, 4> counts{};
  for (const Evidence e : evidence) ++counts[static_cast<std::size_t>(e)];
  return counts;
}
int count(const std::vector<Evidence>& evidence, Evidence kind) {
  return count(evidence)[static_cast<std::size_t>(kind)];
}

TEST(ClassifyOcclusion, AgreesWithAllPairs) {
  Points queries = random_points_within(2000, 2, 1);
  Points blockers = random_points_within(1500, 2, 2);
  queries[5] = {kNoDepth, 0, 1};
  queries[6] = {0, 0, 0};
  blockers[7] = {0, kNoDepth, 1};
  for (const double size : {0.0349066, 0.2}) {
    const SphericalBins bins(size);
    for (const float margin : {0.0F, 0.3F}) {
      const std::vector<Evidence> evidence = classify_occlusion(queries, blockers, bins, margin);
      ASSERT_EQ(evidence.size(), queries.size());
      for (std::size_t i = 0; i < queries.size(); ++i)
        EXPECT_EQ(evidence[i], classify_slowly(queries[i], blockers, bins, margin)) << i;
      const std::array<int, 4> counts = count(evidence);
      EXPECT_GT(counts[static_cast<std::size_t>(Evidence::kOccluded)], 20);
      EXPECT_GT(counts[static_cast<std::size_t>(Evidence::kSeenThrough)], 20);
      EXPECT_GE(counts[static_cast<std::size_t>(Evidence::kUnobserved)], 2);
      EXPECT_EQ(counts[static_cast<std::size_t>(Evidence::kPresent)], 0);
    }
  }
}

TEST(ClassifyOcclusion, ThreeAnswersAndTheMargin) {
  const SphericalBins bins;
  const Points blockers{{0, 0, 1}};
  const auto ask = [&](float z, double margin) {
    return classify_occlusion(Points{{0, 0, z}}, blockers, bins, margin).front();
  };
  EXPECT_EQ(ask(1.5F, 0), Evidence::kOccluded);
  EXPECT_EQ(ask(0.5F, 0), Evidence::kSeenThrough);
  EXPECT_EQ(ask(1, 0), Evidence::kSeenThrough);  // strictly nearer hides
  EXPECT_EQ(ask(1.25F, 0.25), Evidence::kSeenThrough);
  EXPECT_EQ(ask(1.375F, 0.25), Evidence::kOccluded);
  EXPECT_EQ(classify_occlusion(Points{{1, 0, 1}}, blockers, bins, 0).front(), Evidence::kUnobserved);
  EXPECT_EQ(classify_occlusion(Points{{0, 0, 1}}, Points{}, bins, 0).front(), Evidence::kUnobserved);
  EXPECT_TRUE(classify_occlusion(Points{}, blockers, bins, 0).empty());
  EXPECT_THROW((void)classify_occlusion(Points{}, blockers, bins, -0.1), std::invalid_argument);
}

std::vector<Evidence> classify_in_depth_image(const Points& queries_in_camera, const PreparedView& view) {
  return classify_surface({.points = queries_in_camera}, Rigid3::identity(), {view.frame.camera, view.frame.depth_m},
                          {.margin = {.base_m = 0}, .window_radius_px = 1})
      .points;
}

TEST(OcclusionTests, SerialIsParallel) {
  const PreparedView view = see(table());
  const Points queries = random_points_within(30000, 1.5, 9);
  const PointCloud blockers = to_point_cloud(view.cloud, nullptr, false);
  const SphericalBins bins;
  EXPECT_EQ(classify_occlusion(queries, blockers.points, bins, 0, 3),
            classify_occlusion(queries, blockers.points, bins, 0, 1));
}

/// Points in the air above a slanted table, `height_m` over it, that the camera surely sees past.
Points points_above_table(double height_m, const Rigid3& world_from_camera) {
  Points queries;
  const Rigid3 camera_from_world = world_from_camera.inverse();
  for (double x = -0.25; x <= 0.25; x += 0.01)
    for (double y = -0.15; y <= 0.35; y += 0.01)
      queries.push_back((camera_from_world * Eigen::Vector3d(x, y, height_m)).cast<float>());
  return queries;
}

TEST(OcclusionTests, OnASlantTheBinsHideWhatThePixelsSee) {
  const PreparedView view = see(table());
  const PointCloud blockers = to_point_cloud(view.cloud, nullptr, false);
  const auto share_seen_through = [&](double height_m, bool use_bins) {
    const Points queries = points_above_table(height_m, view.frame.world_from_camera);
    const std::vector<Evidence> evidence = use_bins ? classify_occlusion(queries, blockers.points, SphericalBins(), 0)
                                                    : classify_in_depth_image(queries, view);
    EXPECT_EQ(count(evidence, Evidence::kUnobserved), 0);
    return static_cast<double>(count(evidence, Evidence::kSeenThrough)) / static_cast<double>(queries.size());
  };
  // At 10 cm both see past them. At 3 cm, the nearest table point of a bin is nearer than many of them.
  EXPECT_GT(share_seen_through(0.10, true), 0.99);
  EXPECT_GT(share_seen_through(0.10, false), 0.99);
  EXPECT_LT(share_seen_through(0.03, true), 0.95);
  EXPECT_GT(share_seen_through(0.03, false), 0.99);
}

TEST(OcclusionTests, BehindABoxIsHidden) {
  const Box box{{0, 0, 0.1}, {0.12, 0.05, 0.1}};
  Scene scene = table();
  scene.boxes = {box};
  const PreparedView view = see(scene);
  const Rigid3 camera_from_world = view.frame.world_from_camera.inverse();
  Points queries;  // 10 cm behind the box, low
  for (double x = -0.06; x <= 0.06; x += 0.01)
    queries.push_back((camera_from_world * Eigen::Vector3d(x, 0.1, 0.02)).cast<float>());
  const PointCloud blockers = to_point_cloud(view.cloud, nullptr, false);
  EXPECT_EQ(count(classify_occlusion(queries, blockers.points, SphericalBins(), 0), Evidence::kOccluded),
            static_cast<int>(queries.size()));
  EXPECT_EQ(count(classify_in_depth_image(queries, view), Evidence::kOccluded), static_cast<int>(queries.size()));
}

}  // namespace
}  // namespace resight
