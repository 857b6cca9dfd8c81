// SPDX-License-Identifier: Apache-2.0
#include "resight/annotation/refine_over_views.hpp"

#include <gtest/gtest.h>

#include <numbers>

#include "resight/annotation/annotated_scene_test.hpp"
#include "resight/annotation/place_by_click.hpp"
#include "resight/models/pose_distance.hpp"

namespace resight {
namespace {

constexpr double kDegree = std::numbers::pi / 180;

std::vector<NumberedView> numbered(const test::AnnotatedScene& scene, int first, int last) {
  std::vector<NumberedView> views;
  for (int v = first; v <= last; ++v) views.push_back({v, &scene.frames[static_cast<std::size_t>(v)]});
  return views;
}

Rigid3 disturb(const Rigid3& pose, const ObjectModel& model, double shift_m, double angle_rad) {
  const Rigid3 to_middle = Rigid3::from_translation(model.center.cast<double>());
  return Rigid3::from_translation(shift_m * Eigen::Vector3d(1, -0.7, 0.5).normalized()) * pose * to_middle *
         Rigid3::from_axis_angle({0.3, -0.2, 1}, angle_rad) * to_middle.inverse();
}

TEST(RefineOverViews, ReturnsToTheTrueposeFromAFewCentimetres) {
  const test::AnnotatedScene scene;
  for (const auto& [id, object] : scene.document.objects) {
    const ObjectModel& model = scene.library.objects[static_cast<std::size_t>(object.object)];
    const auto views = numbered(scene, object.first_view, object.last_view);
    const auto refined =
        refine_over_views(model, 0.003, disturb(object.world_from_object, model, 0.015, 4 * kDegree), views);
    const PoseDifference error = compare_poses(refined.world_from_object, object.world_from_object, model);
    EXPECT_LT(error.center_distance_m, 0.0025) << model.name << " " << id;
    EXPECT_LT(error.rotation_rad, 1.0 * kDegree) << model.name << " " << id;
    ASSERT_EQ(refined.views.size(), views.size());
    for (const ViewResidual& residual : refined.views) {
      EXPECT_FALSE(residual.is_gone);
      EXPECT_LT(residual.median_distance_m, 0.004);
    }
  }
}

TEST(RefineOverViews, SeesWhenAnObjectIsGone) {
  const test::AnnotatedScene scene;
  for (const auto& [id, object] : scene.document.objects) {
    const ObjectModel& model = scene.library.objects[static_cast<std::size_t>(object.object)];
    for (const ViewResidual& r : assess_views(model, 0.003, object.world_from_object, numbered(scene, 0, 5)))
      EXPECT_EQ(r.is_gone, !object.is_in(r.view)) << model.name << " view " << r.view;
  }
}

TEST(RefineOverViews, WithoutAnyPairThePoseStays) {
  const test::AnnotatedScene scene;
  const Rigid3 far = Rigid3::from_translation({50, 0, 0});
  const auto refined = refine_over_views(scene.library.objects[0], 0.003, far, numbered(scene, 0, 2));
  EXPECT_TRUE(is_same_pose(refined.world_from_object, far));
  EXPECT_EQ(refined.num_pairs, 0);
}

TEST(PlaceByClick, FindsTheObjectBelowTheClick) {
  const test::AnnotatedScene scene;
  for (const auto& [id, object] : scene.document.objects) {
    const ObjectModel& model = scene.library.objects[static_cast<std::size_t>(object.object)];
    const RgbdFrame& frame = scene.frames[static_cast<std::size_t>(object.first_view)];
    const Eigen::Vector3d middle = object.world_from_object * model.center.cast<double>();
    const auto pixel = frame.camera.pixel_of(frame.world_from_camera.inverse() * middle);
    ASSERT_TRUE(pixel);
    const auto pose = place_by_click(model, 0.003, frame, *pixel);
    ASSERT_TRUE(pose);
    const auto refined = refine_over_views(model, 0.003, *pose, numbered(scene, object.first_view, object.last_view));
    const PoseDifference error = compare_poses(refined.world_from_object, object.world_from_object, model);
    EXPECT_LT(error.center_distance_m, 0.003) << model.name << " " << id;
    EXPECT_LT(error.rotation_rad, 1.5 * kDegree) << model.name << " " << id;
  }
}

}  // namespace
}  // namespace resight
