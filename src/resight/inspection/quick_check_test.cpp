// SPDX-License-Identifier: Apache-2.0
#include "resight/inspection/quick_check.hpp"

#include <gtest/gtest.h>
#include <malloc.h>

#include <algorithm>
#include <iterator>
#include <limits>
#include <tuple>

#include "resight/inspection/testing/broken_sequence.hpp"
#include "resight/inspection/testing/swinging_camera.hpp"

namespace resight {
namespace {

using test::good_sequence;
using test::names_of;
using test::render_view;

TEST(CheckQuickly, SeesWhatTheFirstViewsShow) {
  for (const char* name :
       {"depth_x0.1", "depth_x1000", "no_depth", "eight_bits", "black", "intrinsics_of_double_size", "focal_1e-6",
        "focal_1e300", "poses_in_mm", "poses_inverted", "poses_opengl", "poses_100_km_away"}) {
    const test::BrokenSequence broken(good_sequence(), name);
    EXPECT_EQ(check_quickly(broken, true).size(), 1U) << name << " " << names_of(check_quickly(broken, true));
  }
}

TEST(CheckQuickly, SeesWhatLaterViewsShow) {
  for (const int faulty : {3, 5}) {
    std::vector<RgbdFrame> frames;
    for (int v = 0; v < 6; ++v) frames.push_back(good_sequence().read_view(v).value());
    std::ranges::fill(frames[static_cast<std::size_t>(faulty)].depth_m.data(), std::numeric_limits<float>::quiet_NaN());
    const std::vector<Finding> findings = check_quickly(test::MemorySequence(std::move(frames)), true);
    ASSERT_EQ(findings.size(), 1U) << names_of(findings);
    EXPECT_EQ(findings.front().view, faulty);
  }
}

// As views come one by one from a camera.
TEST(PoseCheck, SaysOnceThatPosesAreInverted) {
  const test::BrokenSequence broken(good_sequence(), "poses_inverted");
  PoseCheck check;
  std::vector<Finding> findings;
  for (int v = 0; v < broken.num_views(); ++v)
    std::ranges::move(check.add(broken.read_view(v).value(), v), std::back_inserter(findings));
  ASSERT_EQ(findings.size(), 1U) << names_of(findings);
  EXPECT_EQ(findings.front().fault, "pose_convention");
  EXPECT_TRUE(check.is_done());
}

/// Bytes that are allocated now; always the same with sanitizers, which bring their own heap.
std::size_t allocated_bytes() {
  const struct mallinfo2 info = mallinfo2();
  return info.uordblks + info.hblkhd;
}

TEST(PoseCheck, KeepsNoViewWhenItIsDone) {
  constexpr std::size_t kDepthBytes = std::size_t{4} * 640 * 480;
  RgbdFrame first = render_view(test::look_at_point({0.1, -1.3, 0.8}, {0, 0.1, 0.15}), 0.0015, 1);
  first.color = Image<Rgb8>(640, 480);
  first.depth_m = Image<float>(640, 480, 1.0F);
  RgbdFrame later = first;
  later.world_from_camera.translation.x() += 0.5;
  const std::size_t before = allocated_bytes();
  PoseCheck check;
  std::ignore = check.add(first, 0);
  std::ignore = check.add(later, 1);
  std::ignore = check.add(first, 2);
  EXPECT_TRUE(check.is_done());
  EXPECT_LT(allocated_bytes(), before + kDepthBytes);
}

TEST(CheckQuickly, SaysWhichUnitIsWrong) {
  const auto found = [](double pose_factor, float depth_factor) {
    std::vector<RgbdFrame> frames;
    for (int v = 0; v < 6; ++v) {
      frames.push_back(good_sequence().read_view(v).value());
      // A small scene, so that no depth is too far by itself.
      frames.back().world_from_camera.translation *= 0.2 * pose_factor;
      for (float& z_m : frames.back().depth_m.data()) z_m *= 0.2F * depth_factor;
    }
    const std::vector<Finding> findings = check_quickly(test::MemorySequence(std::move(frames)), true);
    return findings.size() == 1 ? findings.front().message : std::to_string(findings.size()) + " findings";
  };
  EXPECT_EQ(found(1, 1), "0 findings");
  EXPECT_NE(found(1000, 1).find("poses are in millimetres"), std::string::npos) << found(1000, 1);
  EXPECT_NE(found(0.001, 1).find("in metres where millimetres"), std::string::npos) << found(0.001, 1);
  EXPECT_NE(found(1, 10).find("depth is a tenth of what it says"), std::string::npos) << found(1, 10);
  EXPECT_NE(found(1, 5).find("depth is a fifth of what it says"), std::string::npos) << found(1, 5);
  EXPECT_NE(found(5, 1).find("depth is five times what it says"), std::string::npos) << found(5, 1);
}

/// Views of a camera that moves by `step_m` and turns by `turn_rad` from each view to the next, with poses of a unit.
test::MemorySequence moving_views(const Eigen::Vector3d& step_m, double turn_rad, double pose_factor, int num_views) {
  const Rigid3 start = test::look_at_point({0.1, -1.3, 0.8}, {0, 0.1, 0.15});
  std::vector<RgbdFrame> frames;
  for (int v = 0; v < num_views; ++v) {
    const Rigid3 step{Rigid3::from_axis_angle({0, 1, 0}, v * turn_rad).rotation, v * step_m};
    frames.push_back(render_view(start * step, 0.0015, v + 1));
    frames.back().world_from_camera.translation *= pose_factor;
  }
  return test::MemorySequence(std::move(frames));
}

// A camera that moves along a wall sees the same depths everywhere.
TEST(CheckQuickly, SeesPosesInMetresOfACameraThatHardlyTurns) {
  for (const Eigen::Vector3d& step_m : {Eigen::Vector3d(0, 0, 0.06), {0, -0.06, 0}, {0.04, 0, 0.04}})
    for (const double turn_rad : {0.0, 0.02}) {
      const std::string found = names_of(check_quickly(moving_views(step_m, turn_rad, 0.001, 9), true));
      EXPECT_NE(found.find("in metres where millimetres"), std::string::npos)
          << step_m.transpose() << ", turned by " << turn_rad << ": " << found;
    }
}

// By 0.17 rad per view: the rotation alone makes most of the depths agree.
TEST(CheckQuickly, SeesPosesInMetresOfACameraThatCirclesQuickly) {
  const test::BallScene scene{.ball_m = {0, 0, 0.25}, .ball_radius_m = 0.25};
  std::vector<RgbdFrame> frames;
  for (int v = 0; v < 2; ++v) {
    const double angle = -0.35 + 0.17 * v;
    const Rigid3 pose = test::look_at_point({std::sin(angle), -std::cos(angle), 0.6}, scene.ball_m);
    frames.push_back(test::render_ball_scene(scene, pose, 0.0015, static_cast<std::uint64_t>(v + 1)));
  }
  EXPECT_EQ(names_of(check_quickly(test::MemorySequence(frames), true)), "");
  for (RgbdFrame& frame : frames) frame.world_from_camera.translation *= 0.001;
  const std::string found = names_of(check_quickly(test::MemorySequence(frames), true));
  EXPECT_NE(found.find("in metres where millimetres"), std::string::npos) << found;
}

TEST(CheckQuickly, LeavesSlowAndStandingCamerasAlone) {
  for (const double step_m : {0.0001, 0.0005, 0.006})
    for (const double turn_rad : {0.0, 0.001, 0.02}) {
      const auto views = moving_views({0.6 * step_m, 0, 0.8 * step_m}, turn_rad, 1, 7);
      EXPECT_EQ(names_of(check_quickly(views, true)), "") << step_m << " m, turned by " << turn_rad;
    }
}

TEST(CheckQuickly, LeavesPosesAloneThatAreNotUsed) {
  EXPECT_TRUE(check_quickly(test::BrokenSequence(good_sequence(), "poses_inverted"), false).empty());
}

}  // namespace
}  // namespace resight
