// SPDX-License-Identifier: Apache-2.0
#include "resight/registration/camera_errors.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <stdexcept>
#include <vector>

#include "resight/sensor/reduce_frame.hpp"
#include "resight/sensor/testing/ball_scene.hpp"
#include "resight/sensor/testing/memory_sequence.hpp"

namespace resight {
namespace {

constexpr ColorOffsetOptions kColors{.correct = true};
constexpr DepthBiasOptions kBias{.correct = true, .num_threads = 1};

/// Views whose depth lies beside their colours: that of pixel p belongs to pixel p + offset.
std::vector<RgbdFrame> see_beside(Eigen::Vector2i offset_px, double bias_per_m) {
  std::vector<RgbdFrame> frames = test::render_biased_views(bias_per_m);
  for (RgbdFrame& frame : frames) {
    const Image<float> right = frame.depth_m;
    for (int v = 0; v < right.height(); ++v)
      for (int u = 0; u < right.width(); ++u) {
        const bool is_inside = right.contains(u + offset_px.x(), v + offset_px.y());
        frame.depth_m(u, v) =
            is_inside ? right(u + offset_px.x(), v + offset_px.y()) : std::numeric_limits<float>::quiet_NaN();
      }
  }
  return frames;
}

CameraErrors measure_errors(const std::vector<RgbdFrame>& frames) {
  return measure_camera_errors(test::MemorySequence(frames), {}, kColors, kBias);
}

TEST(CameraErrors, OffsetAndBiasAreToldApart) {
  constexpr double kBias_per_m = 0.006;
  const CameraErrors errors = measure_errors(see_beside({3, 2}, kBias_per_m));
  EXPECT_LT((errors.color_offset.offset_px - Eigen::Vector2d(3, 2)).norm(), 0.5)
      << errors.color_offset.offset_px.transpose() << " +- " << errors.color_offset.sigma_px.transpose();
  EXPECT_NEAR(errors.depth_bias.per_m, kBias_per_m, 0.002);
  EXPECT_TRUE(errors.depth_bias.is_significant());
}

TEST(CameraErrors, CorrectedViewsLieWhereTheSceneIs) {
  const std::vector<RgbdFrame> right = test::render_biased_views(0);
  const std::vector<RgbdFrame> beside = see_beside({3, 2}, 0);
  const CameraErrors errors = measure_errors(beside);
  const auto mean_error_m = [&](const CameraErrors& corrected) {
    const PreparedView truth = prepare_view(right[0]);
    const PreparedView view = prepare_corrected(beside[0], corrected, {});
    double sum_m = 0;
    int count = 0;
    for (int v = 20; v < 220; ++v)
      for (int u = 20; u < 300; ++u) {
        const float depth_m = view.frame.depth_m(u, v);
        if (std::isnan(depth_m) || truth.frame.depth_m(u + 3, v + 2) != depth_m) continue;
        sum_m +=
            (view.frame.camera.unproject(u, v, depth_m) - truth.frame.camera.unproject(u + 3, v + 2, depth_m)).norm();
        ++count;
      }
    EXPECT_GT(count, 10000);
    return sum_m / count;
  };
  EXPECT_LT(mean_error_m(errors), 0.2 * mean_error_m({}));
}

TEST(CameraErrors, NothingIsMeasuredUnlessItIsCorrected) {
  const CameraErrors errors = measure_camera_errors(test::MemorySequence(see_beside({3, 2}, 0.006)), {}, {}, {});
  EXPECT_EQ(errors.color_offset.num_views, 0);
  EXPECT_EQ(errors.depth_bias.num_views, 0);
}

TEST(CameraErrorCorrector, LearnsTheOffsetFromTheViewsSoFarUnlessItIsSet) {
  const std::vector<RgbdFrame> frames = see_beside({3, 2}, 0);
  const CameraErrors measured = measure_errors(frames);
  CameraErrorCorrector learning(kColors);
  CameraErrorCorrector set(kColors);
  set.set(measured);
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const double cx = learning.prepare(frames[i], {}).frame.camera.cx;
    if (i < 3) {
      EXPECT_EQ(cx, frames[i].camera.cx) << "of view " << i;
    }
    EXPECT_EQ(set.prepare(frames[i], {}).frame.camera.cx, frames[i].camera.cx - measured.color_offset.offset_px.x());
  }
  EXPECT_LT((learning.errors().color_offset.offset_px - measured.color_offset.offset_px).norm(), 0.1);
  EXPECT_EQ(set.errors().color_offset.offset_px, measured.color_offset.offset_px);
}

TEST(CameraErrorCorrector, KeepsTheIntrinsicsThatItHasChosen) {
  const std::vector<RgbdFrame> frames = see_beside({3, 2}, 0);
  CameraErrorCorrector corrector(kColors);
  std::vector<double> cx;
  int num_changes = 0;
  for (int round = 0; round < 2; ++round)
    for (const RgbdFrame& frame : frames) {
      cx.push_back(corrector.prepare(frame, {}).frame.camera.cx - frame.camera.cx);
      num_changes += corrector.has_changed() ? 1 : 0;
    }
  EXPECT_EQ(num_changes, 1);
  EXPECT_EQ(cx.front(), 0);
  EXPECT_NEAR(cx.back(), -3, 0.3);
  for (const double x : cx) EXPECT_TRUE(x == cx.front() || x == cx.back());
}

TEST(CameraErrors, TheOffsetIsThatOfTheCameraWithMostViews) {
  std::vector<RgbdFrame> frames = see_beside({3, 2}, 0);
  for (const std::size_t v : {1U, 4U, 6U}) frames.push_back(reduce_frame(frames[v], 2));
  const CameraErrors errors = measure_camera_errors(test::MemorySequence(frames), {}, kColors, {});
  EXPECT_EQ(errors.color_offset.num_views, 8);
  EXPECT_LT((errors.color_offset.offset_px - Eigen::Vector2d(3, 2)).norm(), 0.5)
      << errors.color_offset.offset_px.transpose();
  EXPECT_EQ(prepare_corrected(frames[0], errors, {}).frame.camera.cx,
            frames[0].camera.cx - errors.color_offset.offset_px.x());
  const PreparedView other = prepare_corrected(frames.back(), errors, {});
  EXPECT_EQ(other.frame.camera, frames.back().camera);
  EXPECT_EQ(other.frame.color, frames.back().color);
}

TEST(CameraErrors, LargeViewsAreReducedFirst) {
  const RgbdFrame frame = see_beside({4, 2}, 0)[0];
  const PrepareViewOptions halved{.max_pixels = 160 * 120};
  CameraErrors errors;
  const PreparedView given = prepare_view(frame, halved);
  errors.color_offset = {.offset_px = {2, 1}, .sigma_px = {0.2, 0.2}, .num_views = 3, .camera = given.frame.camera};
  const PreparedView view = prepare_corrected(frame, errors, halved);
  EXPECT_EQ(view.frame.camera.width, 160);
  EXPECT_EQ(view.frame.camera.cx, given.frame.camera.cx - 2);
  EXPECT_EQ(view.frame.color(50, 40), given.frame.color(52, 41));
  RgbdFrame unsound = frame;
  unsound.depth_m = Image<float>(8, 6, 1.0F);
  EXPECT_THROW((void)prepare_corrected(unsound, errors, halved), std::invalid_argument);
}

TEST(CameraErrors, UnsoundDepthIsRefusedWhateverIsCorrected) {
  CameraErrors biased;
  biased.depth_bias = {.per_m = 0.01, .sigma_per_m = 0.001, .num_views = 8};
  const RgbdFrame frame = test::render_ball_scene({}, test::look_at_point({-0.8, -0.8, 0.75}, {0, 0, 0.1}));
  for (const CameraErrors& errors : {CameraErrors{}, biased}) {
    EXPECT_NO_THROW((void)prepare_corrected(frame, errors, {}));
    for (const float depth_m : {0.0F, -1.0F, std::numeric_limits<float>::infinity()}) {
      RgbdFrame unsound = frame;
      unsound.depth_m(50, 40) = depth_m;
      EXPECT_THROW((void)prepare_corrected(unsound, errors, {}), std::invalid_argument) << depth_m;
    }
  }
}

}  // namespace
}  // namespace resight
