// SPDX-License-Identifier: Apache-2.0
#include "resight/verification/pose_refinement.hpp"

#include <gtest/gtest.h>

#include <numeric>

#include "resight/verification/scene_preparation.hpp"
#include "resight/verification/testing/analytic_scene.hpp"

namespace resight {
namespace {

using namespace analytic;

// A box on a table, seen all around; every model point is taken for visible (those under the box find no partner).
struct RefineCase {
  Solid solid{Shape::kBox, {0.08, 0.06, 0.1}, plain({200, 50, 40}), on_table(0, 0, 0.05, 0.3)};
  World world{.solids = {solid}};
  VerifyOptions options;
  PreparedModel model = prepare_model(make_model("box", solid), options);
  PreparedScene scene = prepare_scene(merge(render_all(world, circle_of_cameras(4))), options);
  std::vector<int> visible = [this] {
    std::vector<int> all(model.points.size());
    std::iota(all.begin(), all.end(), 0);
    return all;
  }();
};

TEST(RefinePoseOnScene, BringsADisturbedPoseBack) {
  const RefineCase c;
  const Rigid3& truth = c.solid.world_from_object;
  for (const double turn : {0.0, 0.08, -0.1}) {
    const Rigid3 start = disturb(truth, {0.006, -0.005, 0.004}, {1, 1, 1}, turn);
    const Rigid3 refined = refine_pose_on_scene(c.model, start, c.visible, {}, c.scene, {.max_iterations = 30});
    EXPECT_LT((refined.translation - truth.translation).norm(), 0.0015);
    EXPECT_LT(rotation_angle_rad(refined.rotation, truth.rotation), 0.015);
    EXPECT_TRUE(refined.is_rigid(1e-9));
  }
}

TEST(RefinePoseOnScene, LeavesARightPoseWhereItIs) {
  const RefineCase c;
  const Rigid3& truth = c.solid.world_from_object;
  const Rigid3 refined = refine_pose_on_scene(c.model, truth, c.visible, {}, c.scene);
  EXPECT_LT((refined.translation - truth.translation).norm(), 0.001);
  EXPECT_LT(rotation_angle_rad(refined.rotation, truth.rotation), 0.01);
}

TEST(RefinePoseOnScene, DoesNotSlideAlongASingleFace) {
  RefineCase c;
  std::erase_if(c.visible, [&](int i) { return c.model.normals[static_cast<std::size_t>(i)].z() < 0.9F; });
  const Rigid3 start = disturb(c.solid.world_from_object, {0.004, 0.003, 0.005}, {0, 0, 1}, 0.05);
  const Rigid3 refined = refine_pose_on_scene(c.model, start, c.visible, {}, c.scene);
  const Eigen::Vector3d moved = refined.translation - start.translation;
  EXPECT_NEAR(moved.z(), -0.005, 0.001);
  EXPECT_LT(moved.head<2>().norm(), 0.001);
}

TEST(RefinePoseOnScene, CorrespondencesHoldWhatASingleFaceLeavesFree) {
  RefineCase c;
  std::erase_if(c.visible, [&](int i) { return c.model.normals[static_cast<std::size_t>(i)].z() < 0.9F; });
  const Rigid3& truth = c.solid.world_from_object;
  std::vector<Correspondence> correspondences;
  for (std::size_t i = 0; i < c.visible.size(); i += 40) {
    Correspondence& pair = correspondences.emplace_back();
    pair.model_point = c.model.points[static_cast<std::size_t>(c.visible[i])];
    pair.scene_point = Rigid3f(truth) * pair.model_point;
  }
  ASSERT_GE(correspondences.size(), 4U);
  const Rigid3 start = disturb(truth, {0.004, 0.003, 0.005}, {0, 0, 1}, 0.05);
  const Rigid3 refined = refine_pose_on_scene(c.model, start, c.visible, correspondences, c.scene);
  EXPECT_LT((refined.translation - truth.translation).norm(), 0.001);
  EXPECT_LT(rotation_angle_rad(refined.rotation, truth.rotation), 0.01);
}

TEST(RefinePoseOnScene, GivesBackWhatItCannotImprove) {
  const RefineCase c;
  const Rigid3 far = disturb(c.solid.world_from_object, {0.5, 0, 0.3}, {0, 0, 1}, 0);
  const auto same = [](const Rigid3& a, const Rigid3& b) { return a.matrix() == b.matrix(); };
  EXPECT_TRUE(same(refine_pose_on_scene(c.model, far, c.visible, {}, c.scene), far));
  EXPECT_TRUE(same(refine_pose_on_scene(c.model, far, {}, {}, c.scene), far));
  EXPECT_TRUE(same(refine_pose_on_scene(c.model, far, c.visible, {}, c.scene, {.max_iterations = std::nullopt}), far));
  PreparedScene flat = c.scene;
  flat.normals.clear();
  EXPECT_TRUE(same(refine_pose_on_scene(c.model, far, c.visible, {}, flat), far));
  EXPECT_THROW((void)refine_pose_on_scene(c.model, far, c.visible, {}, c.scene, {.max_distance_m = 0}),
               std::invalid_argument);
}

}  // namespace
}  // namespace resight
