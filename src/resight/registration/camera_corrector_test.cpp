// SPDX-License-Identifier: Apache-2.0
#include "resight/registration/camera_corrector.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <stdexcept>

#include "resight/sensor/testing/ball_scene.hpp"

namespace resight {
namespace {

using test::shift_m;
using test::turn_rad;

const Eigen::Vector3d kBall(0, 0.1, 0.05);

Rigid3 left_pose() { return test::look_at_point({-0.3, -0.9, 0.7}, kBall); }
Rigid3 right_pose() { return test::look_at_point({0.1, -0.95, 0.75}, kBall); }

PreparedView view_from(const Rigid3& pose, double noise_m = 0, std::uint64_t seed = 1) {
  return prepare_view(test::render_ball_scene({}, pose, noise_m, seed));
}

Rigid3 pose_off(const Rigid3& pose, double shift, double rotation) {
  return pose *
         Rigid3{Rigid3::from_axis_angle({1, -2, 0.5}, rotation).rotation, shift * Eigen::Vector3d(0.6, -0.3, 0.742)};
}

class CameraCorrectorTest : public ::testing::Test {
 protected:
  static CorrectCameraOptions options() {
    CorrectCameraOptions o;
    o.correct = true;
    return o;
  }
};

TEST_F(CameraCorrectorTest, MendsAPoseThatIsOff) {
  CameraCorrector corrector(options());
  corrector.add_view(view_from(left_pose(), 0.001));
  PreparedView view = view_from(right_pose(), 0.001, 2);
  view.frame.world_from_camera = pose_off(right_pose(), 0.012, 0.015);
  const auto [corrected, correction] = corrector.add_view(view);
  EXPECT_LT(shift_m(corrected, right_pose()), 0.003);
  EXPECT_LT(turn_rad(corrected, right_pose()), 0.003);
  EXPECT_TRUE(correction.is_measured);
  EXPECT_NEAR(correction.moved_m, shift_m(corrected, view.frame.world_from_camera), 1e-9);
  EXPECT_NEAR(correction.moved_rad, 0.015, 0.003);
  EXPECT_GT(correction.sigma_m, 0);
  EXPECT_LT(correction.sigma_m, 0.003);
  EXPECT_LT(correction.sigma_rad, 0.003);
}

TEST_F(CameraCorrectorTest, AFixedCameraStaysWhateverTheViewsSay) {
  CorrectCameraOptions fixed = options();
  fixed.fixed = true;
  CameraCorrector corrector(fixed);
  corrector.add_view(view_from(left_pose(), 0.001));
  PreparedView view = view_from(pose_off(left_pose(), 0.012, 0.015), 0.001, 2);
  view.frame.world_from_camera = left_pose();
  const auto [pose, correction] = corrector.add_view(view);
  EXPECT_EQ(shift_m(pose, left_pose()), 0);
  EXPECT_FALSE(correction.is_measured);
}

// Two of these wrong poses have a little more overlap with the first view than the right one has.
TEST_F(CameraCorrectorTest, MendsAPoseThatIsOffInAnyDirection) {
  for (int axis = 0; axis < 3; ++axis)
    for (const double rotation : {-0.012, 0.012}) {
      CameraCorrector corrector(options());
      corrector.add_view(view_from(left_pose(), 0.001));
      PreparedView view = view_from(right_pose(), 0.001, 2);
      view.frame.world_from_camera = right_pose() * Rigid3::from_axis_angle(Eigen::Vector3d::Unit(axis), rotation);
      const Rigid3 corrected = corrector.add_view(view).world_from_camera;
      EXPECT_LT(shift_m(corrected, right_pose()), 0.003) << axis << ", " << rotation;
      EXPECT_LT(turn_rad(corrected, right_pose()), 0.003) << axis << ", " << rotation;
    }
}

// Only the ball constrains the direction in which these poses are off, and is off by more than the pairs of the finest
// level may be.
TEST_F(CameraCorrectorTest, MendsAPoseThatIsOffAlongFloorAndWall) {
  const Eigen::Vector3d target(0.05, 0.1, 0.05);
  const Rigid3 first = test::look_at_point({-0.9, -0.8, 0.75}, target);
  const Rigid3 second = test::look_at_point({-0.95, -0.7, 0.8}, target);
  for (const double shift_x_m : {0.015, 0.025, 0.035}) {
    CameraCorrector corrector(options());
    corrector.add_view(view_from(first, 0.002));
    PreparedView view = view_from(second, 0.002, 2);
    view.frame.world_from_camera.translation.x() += shift_x_m;
    EXPECT_LT(shift_m(corrector.add_view(view).world_from_camera, second), 0.003) << shift_x_m;
  }
}

TEST_F(CameraCorrectorTest, LeavesARightPoseBitByBit) {
  CameraCorrector corrector(options());
  corrector.add_view(view_from(left_pose(), 0.001));
  const auto [corrected, correction] = corrector.add_view(view_from(right_pose(), 0.001, 2));
  EXPECT_EQ(corrected.matrix(), right_pose().matrix());
  EXPECT_TRUE(correction.is_measured);
  EXPECT_EQ(correction.moved_m, 0);
  EXPECT_EQ(correction.moved_rad, 0);
}

TEST_F(CameraCorrectorTest, DoesNotMoveAViewFarAway) {
  CameraCorrector corrector(options());
  corrector.add_view(view_from(left_pose()));
  PreparedView view = view_from(right_pose());
  view.frame.world_from_camera = pose_off(right_pose(), 0.3, 0.3);
  const Rigid3 given = view.frame.world_from_camera;
  const auto [corrected, correction] = corrector.add_view(view);
  EXPECT_EQ(corrected.matrix(), given.matrix());
  EXPECT_FALSE(correction.is_measured);
}

// Given poses drift by 9 mm per view along an arc. Returns the view of number `k`, and its true pose in `truth`.
PreparedView drifting_view(int k, Rigid3& truth) {
  truth = test::look_at_point({-0.3 + 0.04 * k, -0.9, 0.7}, kBall);
  PreparedView view = view_from(truth, 0.001, static_cast<std::uint64_t>(k + 1));
  view.frame.world_from_camera.translation += k * Eigen::Vector3d(0.008, 0.004, 0);
  return view;
}

// 9 cm of drift are farther than an alignment finds.
TEST_F(CameraCorrectorTest, FollowsDriftAcrossViewsThatCannotBeAligned) {
  for (const float depth_m : {std::numeric_limits<float>::quiet_NaN(), 0.3F}) {  // No depth, or a hand in front.
    CameraCorrector corrector(options());
    Rigid3 truth;
    for (int k = 0; k < 12; ++k) {
      PreparedView view = drifting_view(k, truth);
      if (k == 10) {
        RgbdFrame frame = view.frame;
        std::ranges::fill(frame.depth_m.data(), depth_m);
        view = prepare_view(std::move(frame));
      }
      const auto [corrected, correction] = corrector.add_view(view);
      EXPECT_LT(shift_m(corrected, truth), k == 10 ? 0.015 : 0.006) << k;
      EXPECT_EQ(correction.is_measured, k != 0 && k != 10) << k;
      EXPECT_NEAR(correction.moved_m, shift_m(corrected, view.frame.world_from_camera), 0.002) << k;
    }
  }
}

TEST_F(CameraCorrectorTest, ACameraThatStopsKeepsItsCorrectedPose) {
  CameraCorrector corrector(options());
  Rigid3 truth, stopped;
  for (int k = 0; k < 12; ++k) {
    PreparedView view = drifting_view(std::min(k, 6), truth);
    const Rigid3 given = view.frame.world_from_camera;
    if (k > 6) view = view_from(truth, 0.001, static_cast<std::uint64_t>(k + 1));
    view.frame.world_from_camera = given;
    const Rigid3 corrected = corrector.add_view(view).world_from_camera;
    if (k == 6) stopped = corrected;
    EXPECT_LT(shift_m(corrected, truth), 0.006) << k;
    if (k > 6) {
      EXPECT_EQ(corrected.matrix(), stopped.matrix()) << k;
    }
  }
}

TEST_F(CameraCorrectorTest, OffByDefault) {
  CameraCorrector corrector;
  corrector.add_view(view_from(left_pose()));
  PreparedView view = view_from(right_pose());
  view.frame.world_from_camera = pose_off(right_pose(), 0.012, 0.015);
  EXPECT_EQ(corrector.add_view(view).world_from_camera.matrix(), view.frame.world_from_camera.matrix());
}

TEST_F(CameraCorrectorTest, BadValuesAreRefused) {
  CorrectCameraOptions correct = options();
  correct.min_overlap = 2;
  EXPECT_THROW(CameraCorrector{correct}, std::invalid_argument);
}

}  // namespace
}  // namespace resight
