// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <stdexcept>
#include <tuple>

#include "resight/features/feature_test_scenes.hpp"
#include "resight/features/shot.hpp"

namespace resight {
namespace {

const ShotOptions kKeepFlat{.min_surface_variation = 0};

std::tuple<int, int, int> cube_of(const Eigen::Vector3f& p, double size_m) {
  const auto inverse = static_cast<float>(1.0 / size_m);
  return {static_cast<int>(std::floor(p.x() * inverse)), static_cast<int>(std::floor(p.y() * inverse)),
          static_cast<int>(std::floor(p.z() * inverse))};
}
float distance_to_center(const Eigen::Vector3f& p, double size_m) {
  const auto [x, y, z] = cube_of(p, size_m);
  return (p - (Eigen::Vector3f(static_cast<float>(x), static_cast<float>(y), static_cast<float>(z)).array() + 0.5F)
                      .matrix() *
                  static_cast<float>(size_m))
      .norm();
}

TEST(ExtractShot, SamplesThePointNearestToTheCenterOfEachCube) {
  const PreparedView view = prepare_view(test::make_wavy_frame(1));
  ShotOptions options = kKeepFlat;
  options.support_voxel_m.reset();  // the surface consists of the measured points
  options.support_radius_m = 0.02;
  const FeatureSet features = extract_shot(view, options);
  std::map<std::tuple<int, int, int>, float> nearest;
  for (const Eigen::Vector3f& p : to_point_cloud(view.cloud, nullptr, true).points) {
    const auto [it, is_new] = nearest.try_emplace(cube_of(p, 0.01), 1.0F);
    it->second = std::min(it->second, distance_to_center(p, 0.01));
  }
  ASSERT_GT(features.size(), 2000U);
  EXPECT_LE(features.size(), nearest.size());
  EXPECT_GT(features.size(), nearest.size() * 9 / 10);
  std::map<std::tuple<int, int, int>, int> uses;
  for (const Eigen::Vector3f& p : features.points) {
    ASSERT_NEAR(distance_to_center(p, 0.01), nearest.at(cube_of(p, 0.01)), 1e-6F);
    ASSERT_EQ(++uses[cube_of(p, 0.01)], 1);
  }
}

TEST(ExtractShot, DescribesTheDownsampledSurface) {
  const PreparedView view = prepare_view(test::make_wavy_frame(2));
  const FeatureSet features = extract_shot(view, kKeepFlat);
  ASSERT_GT(features.size(), 1000U);
  const PointCloud support = voxel_downsample(to_point_cloud(view.cloud, nullptr, true), *kKeepFlat.support_voxel_m);
  PointCloud keypoints;
  keypoints.points = features.points;
  keypoints.normals = features.normals;
  EXPECT_EQ(describe_shot(support, keypoints, kKeepFlat).descriptors, features.descriptors);
}

TEST(ExtractShot, StaysWithinTheMask) {
  const PreparedView view = prepare_view(test::make_wavy_frame(3));
  Image<std::uint8_t> mask(view.cloud.width(), view.cloud.height());
  for (int v = 60; v < 160; ++v)
    for (int u = 80; u < 200; ++u) mask(u, v) = 1;
  const FeatureSet features = extract_shot(view, kKeepFlat, &mask);
  ASSERT_GT(features.size(), 100U);
  // Points outside must not affect the descriptors: they equal those of a view without these points.
  RgbdFrame cut = view.frame;
  PreparedView alone = view;
  for (std::size_t i = 0; i < mask.size(); ++i)
    if (mask[i] == 0) alone.cloud.nx[i] = std::numeric_limits<float>::quiet_NaN();
  const FeatureSet expected = extract_shot(alone, kKeepFlat);
  EXPECT_EQ(features.points, expected.points);
  EXPECT_EQ(features.descriptors, expected.descriptors);
  EXPECT_LT(features.size(), extract_shot(view, kKeepFlat).size());
  std::ranges::fill(mask.data(), 0);
  EXPECT_EQ(extract_shot(view, kKeepFlat, &mask).size(), 0U);
}

TEST(ExtractShot, DropsTheTable) {
  RgbdFrame frame = test::make_wavy_frame(3);
  Rng rng(1);
  for (int v = 0; v < frame.camera.height; ++v)  // a ridge on a noisy wall
    for (int u = 0; u < frame.camera.width; ++u)
      frame.depth_m(u, v) =
          static_cast<float>(0.9 - 0.001 * std::max(0, 60 - std::abs(u - 160)) + 0.0005 * rng.normal());
  const FeatureSet features = extract_shot(prepare_view(frame));
  ASSERT_GT(features.size(), 100U);
  for (const Eigen::Vector3f& p : features.points) {  // all lie near the folds at columns 100, 160 and 220
    const double u = frame.camera.project(p.cast<double>()).x();
    EXPECT_LT(std::min({std::abs(u - 100), std::abs(u - 160), std::abs(u - 220)}), 16) << u;
  }
  EXPECT_LT(features.size(), extract_shot(prepare_view(frame), kKeepFlat).size() / 2);
}

TEST(ExtractShot, IsTheSameForAnyNumberOfThreads) {
  const PreparedView view = prepare_view(test::make_wavy_frame(4));
  ShotOptions options = kKeepFlat;
  const FeatureSet serial = extract_shot(view, options);
  options.num_threads = 4;
  const FeatureSet parallel = extract_shot(view, options);
  ASSERT_GT(serial.size(), 1000U);
  EXPECT_EQ(serial.points, parallel.points);
  EXPECT_EQ(serial.descriptors, parallel.descriptors);
}

TEST(ExtractShot, RefusesBadInput) {
  PreparedView view = prepare_view(test::make_wavy_frame(4));
  const Image<std::uint8_t> small(3, 3, 1);
  EXPECT_THROW((void)extract_shot(view, {}, &small), std::invalid_argument);
  view.cloud.nx = {};
  EXPECT_THROW((void)extract_shot(view), std::invalid_argument);
}

}  // namespace
}  // namespace resight
