// SPDX-License-Identifier: Apache-2.0
#include "resight/training/surface.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <numbers>
#include <stdexcept>

#include "resight/core/random.hpp"
#include "resight/geometry/voxel_key.hpp"

namespace resight {
namespace {

SurfaceSamples make_samples(int count, std::uint64_t seed) {
  Rng rng(seed);
  SurfaceSamples samples;
  for (int i = 0; i < count; ++i) {
    const auto coordinate = [&] { return static_cast<float>(rng.uniform(-0.01, 0.01)); };
    samples.cloud.points.emplace_back(coordinate(), coordinate(), coordinate());
    samples.cloud.normals.push_back(Eigen::Vector3f(coordinate(), coordinate(), 0.02F).normalized());
    samples.cloud.colors.push_back({static_cast<std::uint8_t>(rng.below(256)), 0, 7});
    samples.sigma_m.push_back(static_cast<float>(rng.uniform(0.001, 0.004)));
  }
  return samples;
}

TEST(FuseSurface, IsTheWeightedMeanOfEachCube) {
  const SurfaceSamples samples = make_samples(800, 1);
  const PointCloud fused = fuse_surface(samples, 0.005);
  std::map<std::uint64_t, std::vector<std::size_t>> cubes;
  for (std::size_t i = 0; i < 800; ++i) cubes[voxel_key(samples.cloud.points[i], 200.0F)].push_back(i);
  ASSERT_EQ(fused.size(), cubes.size());
  ASSERT_GT(fused.size(), 40U);
  for (std::size_t k = 0; k < fused.size(); ++k) {
    Eigen::Vector3d mean = Eigen::Vector3d::Zero();
    double weight = 0;
    double red = 0;
    for (const std::size_t i : cubes.at(voxel_key(fused.points[k], 200.0F))) {
      const double w = std::pow(samples.sigma_m[i], -2);
      mean += w * samples.cloud.points[i].cast<double>();
      red += w * samples.cloud.colors[i].r;
      weight += w;
    }
    ASSERT_LT((fused.points[k].cast<double>() - mean / weight).norm(), 1e-7);
    ASSERT_NEAR(fused.colors[k].r, red / weight, 0.51);
    ASSERT_EQ(fused.colors[k].b, 7);
    ASSERT_NEAR(fused.normals[k].norm(), 1, 1e-5);
  }
}

TEST(FuseSurface, KeepsTheTwoSidesOfAThinWall) {
  SurfaceSamples samples;
  samples.cloud.points = {{0.001F, 0, 0.0010F}, {0.002F, 0, 0.0012F}, {0.001F, 0, 0.0020F}};
  samples.cloud.normals = {{0, 0, -1}, {0, 0.6F, -0.8F}, {0, 0, 1}};
  samples.cloud.colors.assign(3, Rgb8{});
  samples.sigma_m = {0.001F, 0.001F, 0.002F};
  const PointCloud fused = fuse_surface(samples, 0.01);
  ASSERT_EQ(fused.size(), 2U);
  EXPECT_NEAR(fused.points[0].z(), 0.0011, 1e-6);
  EXPECT_NEAR(fused.points[1].z(), 0.0020, 1e-6);
  EXPECT_LT(fused.normals[0].z(), -0.9F);
  EXPECT_GT(fused.normals[1].z(), 0.9F);
}

TEST(FuseSurface, RefusesNonsenseAndPassesNothing) {
  EXPECT_TRUE(fuse_surface({}, 0.003).empty());
  EXPECT_THROW((void)fuse_surface({}, 0), std::invalid_argument);
  SurfaceSamples samples = make_samples(5, 2);
  samples.sigma_m.pop_back();
  EXPECT_THROW((void)fuse_surface(samples, 0.003), std::invalid_argument);
  samples = make_samples(5, 2);
  samples.cloud.colors.clear();
  EXPECT_THROW((void)fuse_surface(samples, 0.003), std::invalid_argument);
}

// A view of 4x1 pixels: object, object without a normal, object beside an edge, background.
TEST(CollectSurfaceSamples, TakesObjectPixelsAwayFromEdgesIntoTheObjectFrame) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  PreparedView view;
  view.frame.camera = {4, 1, 100, 100, 0, 0};
  view.frame.color = Image<Rgb8>(4, 1, {{1, 1, 1}, {2, 2, 2}, {3, 3, 3}, {4, 4, 4}});
  view.frame.depth_m = Image<float>(4, 1, 1.0F);
  view.frame.world_from_camera = Rigid3::from_axis_angle({0, 1, 0}, std::numbers::pi / 2);
  view.frame.world_from_camera.translation = {0, 5, 0};
  view.cloud.x = Image<float>(4, 1, {0, 0.01F, 0.02F, 0.03F});
  view.cloud.y = Image<float>(4, 1, 0.0F);
  view.cloud.z = Image<float>(4, 1, 1.0F);
  view.cloud.nx = Image<float>(4, 1, {0, nan, 0, 0});
  view.cloud.ny = Image<float>(4, 1, {0, nan, 0, 0});
  view.cloud.nz = Image<float>(4, 1, {-1, nan, -1, -1});
  view.edge_distance_px = Image<float>(4, 1, {5, 5, 1, 5});
  view.noise.lateral_m = Image<float>(4, 1, 0.003F);
  view.noise.axial_m = Image<float>(4, 1, 0.004F);
  const Image<std::uint8_t> mask(4, 1, {1, 255, 1, 0});
  const SurfaceSamples samples = collect_surface_samples(view, mask, 2.0);
  ASSERT_EQ(samples.cloud.size(), 1U);
  EXPECT_LT((samples.cloud.points[0] - Eigen::Vector3f(1, 5, 0)).norm(), 1e-6F);
  EXPECT_LT((samples.cloud.normals[0] - Eigen::Vector3f(-1, 0, 0)).norm(), 1e-6F);
  EXPECT_EQ(samples.cloud.colors[0], (Rgb8{1, 1, 1}));
  EXPECT_NEAR(samples.sigma_m[0], 0.005, 1e-7);
}

}  // namespace
}  // namespace resight
