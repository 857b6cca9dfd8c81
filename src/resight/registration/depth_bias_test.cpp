// SPDX-License-Identifier: Apache-2.0
#include "resight/registration/depth_bias.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "resight/registration/camera_errors.hpp"
#include "resight/sensor/testing/ball_scene.hpp"
#include "resight/sensor/testing/memory_sequence.hpp"

namespace resight {
namespace {

using test::BallScene;

constexpr DepthBiasOptions kOptions{.correct = true, .num_threads = 1};

DepthBias measure(std::vector<RgbdFrame> frames, const DepthBiasOptions& options = kOptions) {
  return measure_camera_errors(test::MemorySequence(std::move(frames)), {}, {}, options).depth_bias;
}

TEST(DepthBias, IsFoundInViewsFromSeveralSides) {
  for (const double bias_per_m : {-0.02, -0.006, 0.006, 0.02}) {
    const DepthBias bias = measure(test::render_biased_views(bias_per_m));
    EXPECT_NEAR(bias.per_m, bias_per_m, 0.0015 + 0.1 * std::abs(bias_per_m));
    EXPECT_LT(std::abs(bias.per_m - bias_per_m), 3 * bias.sigma_per_m);
    EXPECT_TRUE(bias.is_significant()) << bias.per_m << " +- " << bias.sigma_per_m;
    EXPECT_EQ(bias.num_views, 8);
  }
}

TEST(DepthBias, OfAnExactCameraIsNotSignificant) {
  const DepthBias bias = measure(test::render_biased_views(0));
  EXPECT_NEAR(bias.per_m, 0, 0.0015);
  EXPECT_FALSE(bias.is_significant()) << bias.per_m << " +- " << bias.sigma_per_m;
}

TEST(DepthBias, ThingsThatMoveDoNotCount) {
  std::vector<RgbdFrame> frames = test::render_biased_views(0.01);
  BallScene moved;
  moved.ball_m += Eigen::Vector3d(-0.12, 0.06, 0);
  const std::vector<RgbdFrame> later = test::render_biased_views(0.01, moved);
  std::copy(later.begin() + 4, later.end(), frames.begin() + 4);
  EXPECT_NEAR(measure(frames).per_m, 0.01, 0.002);
}

TEST(DepthBias, IsUnknownToAStillCamera) {
  const DepthBias bias = measure(test::render_biased_views(0.02, {}, 0));
  EXPECT_FALSE(bias.is_significant()) << bias.per_m << " +- " << bias.sigma_per_m;
}

TEST(DepthBias, IsNotMeasuredWhereAllPosesAreEqual) {
  std::vector<RgbdFrame> frames = test::render_biased_views(0.02, {}, 0);
  for (RgbdFrame& frame : frames) frame.world_from_camera = frames.front().world_from_camera;
  EXPECT_EQ(measure(frames).num_views, 0);
}

TEST(DepthBias, IsUnknownWithoutOverlapOrViews) {
  std::vector<RgbdFrame> apart;
  for (int v = 0; v < 3; ++v)
    apart.push_back(
        test::render_biased_view({}, test::look_at_point({10.0 * v, -0.9, 0.75}, {10.0 * v + 0.3, 0, 0}), 0.02, 1));
  EXPECT_FALSE(measure(apart).is_significant());
  EXPECT_FALSE(measure({}).is_significant());
  EXPECT_FALSE(measure({apart.front()}).is_significant());
  EXPECT_EQ(measure({apart.front()}).num_views, 0);
  RgbdFrame empty = apart.front();
  for (std::size_t i = 0; i < empty.depth_m.size(); ++i) empty.depth_m[i] = std::nanf("");
  std::vector<RgbdFrame> without_depth(3, empty);
  without_depth[1].world_from_camera.translation.x() += 0.1;
  EXPECT_FALSE(measure(without_depth).is_significant());
}

TEST(DepthBias, LeavesOutViewsThatCannotBeRead) {
  std::vector<RgbdFrame> frames = test::render_biased_views(0.02);
  frames[3] = {};
  const DepthBias bias = measure(frames);
  EXPECT_EQ(bias.num_views, 7);
  EXPECT_NEAR(bias.per_m, 0.02, 0.004);
}

TEST(DepthBias, IsTheSameOnAnyNumberOfThreads) {
  const std::vector<RgbdFrame> frames = test::render_biased_views(0.01);
  DepthBiasOptions parallel = kOptions;
  parallel.num_threads = 3;
  const DepthBias one = measure(frames);
  const DepthBias three = measure(frames, parallel);
  EXPECT_EQ(one.per_m, three.per_m);
  EXPECT_EQ(one.sigma_per_m, three.sigma_per_m);
}

TEST(DepthBias, IsMeasuredOnlyOnRequest) {
  DepthBiasOptions off = kOptions;
  off.correct = false;
  EXPECT_EQ(measure(test::render_biased_views(0.02), off).num_views, 0);
}

TEST(DepthBias, CorrectionUndoesIt) {
  const Rigid3 pose = test::look_at_point({0, -1, 0.75}, {0, 0, 0.1});
  const RgbdFrame exact = test::render_ball_scene({}, pose);
  for (const double bias_per_m : {-0.03, 0.03}) {
    RgbdFrame frame = exact;
    for (std::size_t i = 0; i < frame.depth_m.size(); ++i)
      frame.depth_m[i] = static_cast<float>(1 / (1.0 / exact.depth_m[i] + bias_per_m));
    correct_depth({.per_m = bias_per_m, .sigma_per_m = 0.001, .num_views = 8}, frame);
    for (std::size_t i = 0; i < frame.depth_m.size(); ++i) {
      if (std::isnan(exact.depth_m[i])) continue;
      ASSERT_NEAR(frame.depth_m[i], exact.depth_m[i], 1e-5);
    }
  }
}

TEST(DepthBias, IsNotCorrectedUnlessSureOfIt) {
  EXPECT_EQ((DepthBias{.per_m = 0.01, .sigma_per_m = 0.004, .num_views = 8}).corrected_m(2), 2);
  EXPECT_EQ((DepthBias{.per_m = 0.06, .sigma_per_m = 0.001, .num_views = 8}).corrected_m(2), 2) << "no bias: a unit";
  const DepthBias sure{.per_m = 0.01, .sigma_per_m = 0.001, .num_views = 8};
  EXPECT_FLOAT_EQ(sure.corrected_m(2), 2 / 0.98F);
  EXPECT_TRUE(std::isnan(sure.corrected_m(100)));
  EXPECT_TRUE(std::isnan(sure.corrected_m(std::nanf(""))));
}

}  // namespace
}  // namespace resight
