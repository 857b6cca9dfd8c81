// SPDX-License-Identifier: Apache-2.0
#include "resight/registration/view_alignment.hpp"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <algorithm>

#include "resight/registration/twist.hpp"
#include "resight/sensor/testing/ball_scene.hpp"

namespace resight {
namespace {

using test::BallScene;
using test::shift_m;
using test::turn_rad;

const Eigen::Vector3d kTarget(0, 0.1, 0.05);

Rigid3 first_pose() { return test::look_at_point({-0.3, -0.9, 0.7}, kTarget); }
Rigid3 second_pose() { return test::look_at_point({0.1, -0.95, 0.75}, kTarget); }

PreparedView prepared(const BallScene& scene, const Rigid3& pose, double noise_m = 0, std::uint64_t seed = 1) {
  return prepare_view(test::render_ball_scene(scene, pose, noise_m, seed));
}

Rigid3 off(const Rigid3& pose, double shift, double rotation) {
  return pose *
         Rigid3{Rigid3::from_axis_angle({1, -2, 0.5}, rotation).rotation, shift * Eigen::Vector3d(0.6, -0.3, 0.742)};
}

class Alignment : public ::testing::Test {
 protected:
  AlignmentView first = make_alignment_view(prepared({}, first_pose()));
  AlignmentView second = make_alignment_view(prepared({}, second_pose()));
  std::vector<AlignmentTarget> targets{{&first, first_pose()}};
};

TEST_F(Alignment, FindsThePoseWithoutNoise) {
  const AlignedView aligned = align_view(second, targets, off(second_pose(), 0.03, 0.04));
  EXPECT_LT(shift_m(aligned.world_from_camera, second_pose()), 0.0015);
  EXPECT_LT(turn_rad(aligned.world_from_camera, second_pose()), 0.002);
  EXPECT_TRUE(aligned.world_from_camera.is_rigid(1e-9));
  EXPECT_GT(aligned.overlap, 0.6);
  EXPECT_LT(aligned.seen_through, 0.01);
}

TEST_F(Alignment, BlocksOfOtherColorsAreDissimilar) {
  RgbdFrame frame = test::render_ball_scene({}, second_pose());
  const int middle = frame.color.width() / 2;
  for (int v = 0; v < frame.color.height(); ++v)
    for (int u = 0; u < middle; ++u) {
      const auto inverse = static_cast<std::uint8_t>(255 - frame.color(u, v).r);
      frame.color(u, v) = {inverse, inverse, inverse};
    }
  const AlignmentView half = make_alignment_view(prepare_view(std::move(frame)));
  const Image<BlockSimilarity> blocks = compare_blocks(half, targets[0], second_pose());
  int num_known = 0;
  for (int y = 0; y < blocks.height(); ++y)
    for (int x = 0; x < blocks.width(); ++x) {
      if (blocks(x, y) == BlockSimilarity::kUnknown) continue;
      ++num_known;
      EXPECT_EQ(blocks(x, y) == BlockSimilarity::kDissimilar, 2 * x < blocks.width()) << x << " " << y;
    }
  EXPECT_GT(num_known, 24);
}

TEST_F(Alignment, ChangedThingsDoNotPull) {
  BallScene moved;
  moved.ball_m += Eigen::Vector3d(0.05, -0.03, 0);  // Overlaps its former place.
  const AlignmentView changed = make_alignment_view(prepared(moved, second_pose()));
  const AlignedView aligned = align_view(changed, targets, off(second_pose(), 0.02, 0.02));
  EXPECT_LT(shift_m(aligned.world_from_camera, second_pose()), 0.003);
  EXPECT_LT(turn_rad(aligned.world_from_camera, second_pose()), 0.004);
}

TEST_F(Alignment, TextureFixesWhatShapeLeavesOpen) {
  BallScene floor;
  floor.has_ball = false;
  const Rigid3 down_a = test::look_at_point({0, -0.3, 0.9}, {0, 0, 0});
  const Rigid3 down_b = test::look_at_point({0.05, -0.28, 0.9}, {0.05, 0, 0});
  const AlignmentView a = make_alignment_view(prepared(floor, down_a));
  const AlignmentView b = make_alignment_view(prepared(floor, down_b));
  const std::vector<AlignmentTarget> one{{&a, down_a}};
  const Rigid3 start = down_b * Rigid3::from_translation({0.015, 0, 0});  // Along the floor.
  EXPECT_LT(shift_m(align_view(b, one, start).world_from_camera, down_b), 0.002);
  AlignViewOptions depth_only;
  depth_only.brightness_sigma = 0;
  const AlignedView slid = align_view(b, one, start, depth_only);
  EXPECT_GT(shift_m(slid.world_from_camera, down_b), 0.01) << "a plane does not constrain the shift";
  EXPECT_LT(shift_m(slid.world_from_camera, start), 0.004) << "unconstrained directions stay";
}

TEST_F(Alignment, BrighterLightIsNoError) {
  PreparedView brighter = prepared({}, second_pose());
  for (std::size_t i = 0; i < brighter.frame.color.size(); ++i) {
    Rgb8& c = brighter.frame.color[i];
    c.r = c.g = c.b = static_cast<std::uint8_t>(std::min(255, c.r + 25));
  }
  const AlignedView aligned = align_view(make_alignment_view(brighter), targets, off(second_pose(), 0.02, 0.02));
  EXPECT_LT(shift_m(aligned.world_from_camera, second_pose()), 0.0025);
}

TEST_F(Alignment, AnUntexturedFloorIsOpenAlongItself) {
  BallScene bare;
  bare.has_ball = bare.textured = false;
  const Rigid3 down = test::look_at_point({0, -0.5, 0.9}, {0, -0.2, 0});
  const AlignmentView a = make_alignment_view(prepared(bare, down, 0.0015, 1));
  const AlignmentView b = make_alignment_view(prepared(bare, down, 0.0015, 2));
  const std::vector<AlignmentTarget> one{{&a, down}};
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, 6, 6>> solver(align_view(b, one, down).information);
  EXPECT_LT(solver.eigenvalues()[2], 1) << "two shifts and one rotation";
  EXPECT_GT(solver.eigenvalues()[3], 1e4);
}

TEST_F(Alignment, UncertaintyIsThatOfTheErrors) {
  // With 20 noisy views, the errors in units of their covariance are neither far above nor far below one.
  double sum = 0;
  const PreparedView noisy_first = prepared({}, first_pose(), 0.0015, 100);
  const AlignmentView target = make_alignment_view(noisy_first);
  const std::vector<AlignmentTarget> one{{&target, first_pose()}};
  for (std::uint64_t i = 0; i < 20; ++i) {
    const AlignmentView view = make_alignment_view(prepared({}, second_pose(), 0.0015, i));
    const AlignedView aligned = align_view(view, one, off(second_pose(), 0.01, 0.01));
    const Twist error = to_twist(aligned.world_from_camera.inverse() * second_pose());
    sum += error.dot(aligned.information * error) / 6 / 20;
  }
  EXPECT_GT(sum, 0.05);
  EXPECT_LT(sum, 5);
}

TEST_F(Alignment, SaysHowMuchIsSeenThrough) {
  BallScene without;
  without.has_ball = false;
  const AlignmentView bare = make_alignment_view(prepared(without, first_pose()));
  const std::vector<AlignmentTarget> one{{&bare, first_pose()}};
  const double with_ball = evaluate_alignment(second, one, second_pose()).seen_through;
  EXPECT_GT(with_ball, 0.02);  // The ball occupies what the first view saw as free space in front of the wall.
  EXPECT_LT(evaluate_alignment(second, targets, second_pose()).seen_through, 0.01);
}

// Small images have fewer levels than large ones, and only the finest is compared.
TEST_F(Alignment, ViewsWithFewerLevelsAreComparedToo) {
  const PreparedView view = prepared({}, first_pose());
  AlignmentView coarse = make_alignment_view(view);
  ASSERT_GT(coarse.levels.size(), 1U);
  const std::vector<AlignmentTarget> whole{{&coarse, first_pose()}};
  const double overlap = evaluate_alignment(second, whole, second_pose()).overlap;
  EXPECT_GT(overlap, 0.1);
  coarse.levels.resize(1);
  EXPECT_EQ(evaluate_alignment(second, whole, second_pose()).overlap, overlap);
  EXPECT_THROW((void)align_view(second, whole, second_pose()), std::invalid_argument);
}

TEST_F(Alignment, SameForAnyNumberOfThreads) {
  AlignViewOptions serial, parallel;
  parallel.num_threads = 4;
  const Rigid3 start = off(second_pose(), 0.03, 0.03);
  const AlignedView a = align_view(second, targets, start, serial);
  const AlignedView b = align_view(second, targets, start, parallel);
  EXPECT_EQ(a.world_from_camera.matrix(), b.world_from_camera.matrix());
  EXPECT_EQ(a.information, b.information);
}

TEST_F(Alignment, WithoutOverlapStaysWhereItIs) {
  const Rigid3 away = test::look_at_point({5, 5, 1}, {9, 9, 0.5});
  const AlignedView aligned = align_view(second, targets, away);
  EXPECT_EQ(aligned.num_pairs, 0);
  EXPECT_EQ(aligned.overlap, 0);
  EXPECT_LT(shift_m(aligned.world_from_camera, away), 1e-12);
  EXPECT_EQ(align_view(second, {}, away).num_pairs, 0);
}

TEST_F(Alignment, MaskedPointsStillHide) {
  const PreparedView view = prepared({}, first_pose());
  const Image<std::uint8_t> nothing(view.cloud.width(), view.cloud.height());
  const AlignmentView masked = make_alignment_view(view, {}, &nothing);
  const std::vector<AlignmentTarget> one{{&masked, first_pose()}};
  EXPECT_EQ(evaluate_alignment(second, one, second_pose()).num_pairs, 0);
  EXPECT_LT(evaluate_alignment(second, one, second_pose()).seen_through, 0.01);
}

TEST(AlignmentView, EmptyDepthHasNothingToAlign) {
  RgbdFrame frame = test::render_ball_scene({}, first_pose());
  std::ranges::fill(frame.depth_m.data(), std::numeric_limits<float>::quiet_NaN());
  const AlignmentView empty = make_alignment_view(prepare_view(frame));
  const AlignmentView full = make_alignment_view(prepared({}, first_pose()));
  const std::vector<AlignmentTarget> one{{&full, first_pose()}};
  EXPECT_EQ(align_view(empty, one, first_pose()).num_pairs, 0);
}

TEST(AlignmentView, LevelsLieOverEachOther) {
  // A brightness ramp that is linear in the pixel position stays linear at each level, over the same points.
  RgbdFrame frame = test::render_ball_scene({}, first_pose());
  for (int v = 0; v < frame.color.height(); ++v)
    for (int u = 0; u < frame.color.width(); ++u) {
      const auto level = static_cast<std::uint8_t>(u / 2);
      frame.color(u, v) = {level, level, level};
    }
  AlignmentViewOptions options;
  options.mean_radius = 1;  // The mean of all: constant in the middle of the image.
  const AlignmentView view = make_alignment_view(prepare_view(frame), options);
  ASSERT_EQ(view.levels.size(), 3U);
  for (std::size_t l = 1; l < 3; ++l) {
    const AlignmentLevel& level = view.levels[l];
    const double right = level.camera.unproject(30, 20, 1).x(), left = level.camera.unproject(10, 20, 1).x();
    const double step_per_ray = (level.points(30, 20).brightness - level.points(10, 20).brightness) / (right - left);
    EXPECT_NEAR(step_per_ray, frame.camera.fx / 2, 2) << "level " << l;
  }
}

TEST(AlignViewOptions, BadValuesAreRefused) {
  AlignViewOptions options;
  options.max_distance_m = 0;
  EXPECT_THROW(options.check(), std::invalid_argument);
  AlignmentViewOptions view;
  view.num_levels = 0;
  EXPECT_THROW(view.check(), std::invalid_argument);
}

}  // namespace
}  // namespace resight
