// SPDX-License-Identifier: Apache-2.0
#include "resight/reconstruction/dynamic_scene.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "resight/changes/analytic_scene_test_util.hpp"
#include "resight/reconstruction/removal_history_test_util.hpp"
#include "resight/sensor/testing/ball_scene.hpp"

namespace resight {
namespace {

using namespace testing_scene;
const Box kFirstBox{{0, 0, 0.1}, {0.12, 0.05, 0.1}, 0.4};
const Box kOther{{0.3, 0.1, 0.06}, {0.05, 0.05, 0.06}};

Scene with(const std::vector<Box>& boxes) {
  Scene scene = table();
  scene.boxes = boxes;
  return scene;
}

struct Step {
  Scene scene;
  Rigid3 pose;
};

/// The box disappears in view 2 and is back in view 4; the other box appears in view 3. View 1 looks away, so that no
/// change affects it.
std::vector<Step> story() {
  const Rigid3 left = look_at({-0.3, -0.9, 0.8}, {0, 0, 0.05});
  const Rigid3 right = look_at({0.3, -0.9, 0.8}, {0, 0, 0.05});
  const Rigid3 away = look_at({1.6, -0.9, 0.8}, {1.6, 0, 0.05});
  return {{with({kFirstBox}), left}, {with({kFirstBox}), away},         {with({}), usual_pose()},
          {with({kOther}), right},   {with({kFirstBox, kOther}), left}, {with({kFirstBox}), usual_pose()}};
}

/// Alg. 1 from the raw views in every step, with the removals in a history.
class FromScratch {
 public:
  explicit FromScratch(int num_previous_views) : num_previous_views_(num_previous_views) {}

  ChangeResult add(const PreparedView& view) {
    const int number = static_cast<int>(views_.size());
    ChangeResult changes;
    if (number > 0) changes = detect_changes(psi_.cloud_in_world, view, {}, pointers(cleared_));
    history_.add(number, changes.removed_in_world);
    views_.push_back(view);
    cleared_.clear();
    for (int v = std::max(0, number - num_previous_views_); v <= number; ++v)
      cleared_.push_back(clear_removed_points(views_[static_cast<std::size_t>(v)], history_.removed_after(v), 0.02));
    psi_ = integrate_views(pointers(cleared_));
    return changes;
  }
  [[nodiscard]] const PointCloud& reconstruction() const { return psi_.cloud_in_world; }

 private:
  static std::vector<const PreparedView*> pointers(const std::vector<PreparedView>& views) {
    std::vector<const PreparedView*> result;
    for (const PreparedView& view : views) result.push_back(&view);
    return result;
  }

  int num_previous_views_;
  std::vector<PreparedView> views_;
  std::vector<PreparedView> cleared_;
  RemovalHistory history_;
  Reconstruction psi_;
};

TEST(DynamicScene, AgreesWithStartingFromScratch) {
  for (const int num_previous_views : {1, 2, 5}) {
    DynamicSceneOptions options;
    options.num_previous_views = num_previous_views;
    DynamicScene scene(options);
    FromScratch twin(num_previous_views);
    std::size_t num_removed = 0;
    std::size_t num_novel = 0;
    for (const Step& step : story()) {
      const PreparedView view = see(step.scene, step.pose);
      const ChangeResult expected = twin.add(view);
      const ChangeResult changes = scene.add_view(view);
      EXPECT_EQ(changes.removed_in_world.points, expected.removed_in_world.points);
      EXPECT_EQ(changes.novel_in_world.points, expected.novel_in_world.points);
      ASSERT_EQ(scene.reconstruction().points, twin.reconstruction().points);
      EXPECT_EQ(scene.reconstruction().normals, twin.reconstruction().normals);
      num_removed += changes.removed_in_world.size();
      num_novel += changes.novel_in_world.size();
    }
    EXPECT_EQ(static_cast<int>(scene.window().size()), num_previous_views + 1);
    if (num_previous_views >= 2) {
      EXPECT_GT(num_removed, 500U);
      EXPECT_GT(num_novel, 500U);
    }
  }
}

// Old views leave the window; the result equals a reconstruction from scratch.
TEST(DynamicScene, AgreesWithStartingFromScratchAlongAWay) {
  DynamicSceneOptions options;
  options.num_previous_views = 0;
  DynamicScene scene(options);
  FromScratch twin(0);
  for (int step = 0; step < 8; ++step) {
    const double x = 1.2 * step;
    const PreparedView view = see(with({kFirstBox}), look_at({x, -0.9, 0.8}, {x, 0, 0.05}));
    (void)scene.add_view(view);
    (void)twin.add(view);
    ASSERT_EQ(scene.reconstruction().points, twin.reconstruction().points) << step;
  }
}

// The second camera is said to be 12 mm above where it is. Where K = 0, there is nothing to compare it with.
TEST(DynamicScene, CorrectsGivenPosesBeforeItComparesViews) {
  const Rigid3 true_pose = look_at({0.3, -0.9, 0.8}, {0, 0, 0.05});
  const Rigid3 given_pose = Rigid3::from_translation({0, 0, 0.012}) * true_pose;
  for (const int num_previous_views : {0, 3}) {
    DynamicSceneOptions options;
    options.num_previous_views = num_previous_views;
    options.poses.correct = true;
    DynamicScene scene(options);
    (void)scene.add_view(see(with({kFirstBox, kOther})));
    PreparedView view = see(with({kFirstBox, kOther}), true_pose);
    view.frame.world_from_camera = given_pose;
    StageTimes times;
    (void)scene.add_view(std::move(view), &times);
    const Rigid3& corrected = scene.window().back().raw.world_from_camera;
    const double error_m = (corrected.translation - true_pose.translation).norm();
    if (num_previous_views > 0)
      EXPECT_LT(error_m, 0.002);
    else
      EXPECT_TRUE(is_same_pose(corrected, given_pose));
    ASSERT_EQ(times.stages().size(), 2U);
    EXPECT_EQ(times.stages()[0].stage, "poses");
  }
}

std::vector<DynamicSceneOptions> both_tests() {
  std::vector<DynamicSceneOptions> both(2);
  both[1].changes.test = DepthTestOptions{};
  return both;
}

PreparedView view_of_pose(double degrees, const Rigid3& given_from_true) {
  const double angle = degrees * 3.14159 / 180;
  PreparedView view =
      see(with({kFirstBox, kOther}), look_at({0.9 * std::sin(angle), -0.9 * std::cos(angle), 0.8}, {0, 0, 0.05}));
  view.frame.world_from_camera = given_from_true * view.frame.world_from_camera;
  return view;
}
const Rigid3 kWrong = Rigid3::from_translation({0.1, 0.1, 0.25});

TEST(DynamicScene, AViewWithAWrongPoseIsForgotten) {
  for (const DynamicSceneOptions& options : both_tests()) {
    DynamicScene scene(options);
    for (int k = 0; k < 3; ++k) (void)scene.add_view(view_of_pose(5 * k, Rigid3::identity()));
    EXPECT_TRUE(scene.add_view(view_of_pose(15, kWrong)).pose_suspect);
    for (int k = 4; k < 6; ++k) {
      const ChangeResult changes = scene.add_view(view_of_pose(5 * k, Rigid3::identity()));
      EXPECT_FALSE(changes.pose_suspect);
      EXPECT_LT(changes.removed_in_world.size(), 30U) << k;
      EXPECT_LT(changes.novel_in_world.size(), 30U) << k;
    }
    EXPECT_EQ(scene.view_numbers(), (std::vector{0, 1, 2, 4, 5}));
  }
}

TEST(DynamicScene, TwoViewsThatAgreeReplaceThoseBefore) {
  for (const DynamicSceneOptions& options : both_tests()) {
    DynamicScene scene(options);
    for (int k = 0; k < 6; ++k) {
      const ChangeResult changes = scene.add_view(view_of_pose(5 * k, k < 3 ? Rigid3::identity() : kWrong));
      EXPECT_EQ(changes.pose_suspect, k == 3);
      EXPECT_LT(changes.removed_in_world.size(), 30U) << k;
    }
    EXPECT_EQ(scene.view_numbers(), (std::vector{3, 4, 5}));
  }
}

// A hand covers more than half of the image of a still camera; a thing is put down behind it.
void expect_hand_is_no_wrong_pose(const CorrectCameraOptions& poses) {
  DynamicSceneOptions options;
  options.poses = poses;
  options.changes.test = DepthTestOptions{};
  DynamicScene scene(options);
  const auto see_after = [&](const std::vector<Box>& boxes, bool with_hand) {
    RgbdFrame frame = see(with(boxes), usual_pose()).frame;
    if (with_hand)
      for (int v = 0; v < frame.depth_m.height(); ++v)
        for (int u = 0; u < frame.depth_m.width() * 6 / 10; ++u) frame.depth_m(u, v) = 0.3F;
    return scene.add_view(prepare_view(std::move(frame)));
  };
  for (int k = 0; k < 3; ++k) EXPECT_TRUE(see_after({kFirstBox}, false).novel_in_world.empty());
  for (int k = 0; k < 2; ++k) {
    const ChangeResult changes = see_after({kFirstBox, kOther}, true);
    EXPECT_FALSE(changes.pose_suspect);
    EXPECT_EQ(changes.novel_in_world.size() > 1000, k == 0);
  }
  const ChangeResult after = see_after({kOther}, false);
  EXPECT_FALSE(after.pose_suspect);
  EXPECT_GT(after.removed_in_world.size(), 1000U) << "the hand, and the box";
  EXPECT_EQ(scene.view_numbers().size(), 6U);
}

TEST(DynamicScene, AHandBeforeAStillCameraIsNoWrongPose) {
  expect_hand_is_no_wrong_pose({.correct = true});
  expect_hand_is_no_wrong_pose({.fixed = true});
}

TEST(DynamicScene, ForgottenViewsAreNotCompared) {
  DynamicScene scene;
  for (int k = 0; k < 2; ++k) (void)scene.add_view(see(with({kFirstBox}), usual_pose()));
  scene.forget_views();
  EXPECT_TRUE(scene.reconstruction().empty());
  const ChangeResult changes = scene.add_view(see(with({}), usual_pose()));
  EXPECT_TRUE(changes.removed_in_world.empty());
  EXPECT_EQ(scene.view_numbers(), (std::vector{2}));
  EXPECT_EQ(scene.num_views(), 3);
}

// The table behind the ball is beyond the limit, and still shows that the ball is new, or gone.
TEST(DynamicScene, WhatLiesBeyondTheLimitOfDepthIsStillEvidence) {
  const auto count_changed = [](const DynamicSceneOptions& options, double height_m, bool added) {
    const Rigid3 camera = test::look_at_point({-0.9, -0.8, height_m}, {0.1, 0.05, 0.12});
    test::BallScene with_ball, without;
    without.has_ball = false;
    DynamicScene scene(options);
    scene.add_view(
        prepare_view(test::render_ball_scene(added ? without : with_ball, camera, 0.001, 1), options.prepare));
    const ChangeResult changes = scene.add_view(
        prepare_view(test::render_ball_scene(added ? with_ball : without, camera, 0.001, 2), options.prepare));
    return added ? static_cast<std::size_t>(std::ranges::count(changes.novel_mask.data(), 1))
                 : changes.removed_in_world.size();
  };
  DynamicSceneOptions points, depth;
  depth.changes.test = DepthTestOptions{};
  const auto near = [](DynamicSceneOptions options, double max_depth_m) {
    options.prepare.max_depth_m = max_depth_m;
    return options;
  };
  const auto num_removed = static_cast<double>(count_changed(points, 0.45, false));
  EXPECT_NEAR(static_cast<double>(count_changed(near(points, 1.35), 0.45, false)), num_removed, 0.05 * num_removed);
  const auto num_added = static_cast<double>(count_changed(depth, 0.25, true));
  EXPECT_NEAR(static_cast<double>(count_changed(near(depth, 1.3), 0.25, true)), num_added, 0.05 * num_added);
}

TEST(DynamicScene, WithoutChangeDetectionTheGhostStays) {
  for (const bool detect : {false, true}) {
    DynamicSceneOptions options;
    options.detect_changes = detect;
    DynamicScene scene(options);
    (void)scene.add_view(see(with({kFirstBox})));
    const int before = count_at(kFirstBox, scene.reconstruction(), 0.002);
    const ChangeResult changes = scene.add_view(see(with({})));
    const int after = count_at(kFirstBox, scene.reconstruction(), 0.002);
    ASSERT_GT(before, 500);
    if (detect) {
      EXPECT_LT(after, before / 2);  // The box also contains the table below it.
      EXPECT_FALSE(changes.removed_in_world.empty());
    } else {
      EXPECT_GE(after, before);
      EXPECT_TRUE(changes.removed_in_world.empty());
    }
  }
}

TEST(DynamicScene, SerialIsParallel) {
  DynamicSceneOptions options;
  DynamicScene serial(options);
  options.changes.num_threads = options.integrate.num_threads = options.prepare.num_threads = 3;
  DynamicScene parallel(options);
  for (const Step& step : story()) {
    const PreparedView view = see(step.scene, step.pose);
    (void)serial.add_view(view);
    (void)parallel.add_view(view);
    ASSERT_GT(serial.reconstruction().size(), 1000U);
    EXPECT_EQ(parallel.reconstruction().points, serial.reconstruction().points);
    EXPECT_EQ(parallel.reconstruction().colors, serial.reconstruction().colors);
  }
}

TEST(DynamicScene, AViewThatIsNotPreparedChangesNothing) {
  DynamicSceneOptions options;
  options.integrate.num_threads = 3;
  options.poses.correct = true;
  DynamicScene scene(options), other(options);
  for (const Step& step : story()) {
    const PreparedView view = see(step.scene, step.pose);
    PreparedView unprepared = see(with({}), step.pose);  // All boxes would be removed.
    unprepared.frame.world_from_camera.translation.x() += 0.01;
    unprepared.noise.axial_m = {};
    EXPECT_THROW((void)scene.add_view(std::move(unprepared)), std::invalid_argument);
    const ChangeResult changes = scene.add_view(view);
    EXPECT_EQ(changes.removed_in_world.points, other.add_view(view).removed_in_world.points);
    EXPECT_EQ(scene.reconstruction().points, other.reconstruction().points);
  }
}

TEST(DynamicScene, RefusesNonsense) {
  DynamicSceneOptions options;
  options.num_previous_views = -1;
  EXPECT_THROW(DynamicScene{options}, std::invalid_argument);
  options = {};
  options.clear_tolerance_m = 0;
  EXPECT_THROW(DynamicScene{options}, std::invalid_argument);
}

}  // namespace
}  // namespace resight
