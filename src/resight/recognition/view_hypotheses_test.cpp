// SPDX-License-Identifier: Apache-2.0
#include "resight/recognition/view_hypotheses.hpp"

#include <gtest/gtest.h>

namespace resight {
namespace {

TEST(GenerationSettings, DependOnTheGenerationOnly) {
  const RecognizerConfig base = RecognizerConfig::from_preset("mvr");
  const std::string text = generation_settings(base);
  EXPECT_GT(text.size(), 100U);
  EXPECT_EQ(generation_settings(RecognizerConfig::from_preset("mvr-chd")), text);

  RecognizerConfig later = base;
  later.num_previous_views = 1;
  later.hypotheses.cluster.reset();
  later.detections.min_reported_share = 0.5;
  later.remember_objects = true;
  later.hypotheses.min_carried_share = 0.5;
  later.changes.detection.voxel_m *= 2;
  later.verify.selection.outlier_weight *= 2;
  later.history.same_place_m *= 2;
  later.integrate.voxel_m *= 2;
  EXPECT_EQ(generation_settings(later), text);

  RecognizerConfig normals = base, sift = base, shot = base, match = base, grouping = base;
  normals.prepare.normals.window_radius_px += 1;
  sift.features.sift.contrast_threshold *= 2;
  shot.features.shot.support_radius_m *= 2;
  match.features.match.sift_neighbors += 1;
  grouping.hypotheses.generate.grouping.min_group_size += 1;
  for (const RecognizerConfig* changed : {&normals, &sift, &shot, &match, &grouping})
    EXPECT_NE(generation_settings(*changed), text);
}

// Which views are searched, and where, then depends on what is known, and that on all settings.
TEST(GenerationSettings, AreAllSettingsIfViewsOrPlacesAreSkipped) {
  RecognizerConfig base = RecognizerConfig::from_preset("default");
  base.search.place_interval = 4;
  RecognizerConfig other = base;
  other.num_previous_views = base.num_previous_views + 1;
  EXPECT_NE(generation_settings(other), generation_settings(base));
  other = base;
  other.verify.selection.outlier_weight *= 2;
  EXPECT_NE(generation_settings(other), generation_settings(base));
  base.search.place_interval = other.search.place_interval = std::nullopt;
  EXPECT_NE(generation_settings(other), generation_settings(base));
  base.search.max_new_share = other.search.max_new_share = std::nullopt;
  EXPECT_EQ(generation_settings(other), generation_settings(base));
}

TEST(ViewHypothesisStore, ReturnsWhatWasStored) {
  ViewHypothesisStore store;
  EXPECT_EQ(store.find(3), nullptr);
  ViewHypotheses made;
  made.hypotheses.resize(2);
  made.times.add("sift", 0.5, 0.25);
  EXPECT_EQ(store.add(3, made).hypotheses.size(), 2U);
  ASSERT_NE(store.find(3), nullptr);
  EXPECT_EQ(store.find(3)->times.total_wall_s(), 0.5);
  EXPECT_EQ(store.find(2), nullptr);
}

TEST(MoveHypotheses, TransformsThemWithThePose) {
  ViewHypotheses made;
  made.world_from_camera = {Rigid3::from_axis_angle({1, 2, 3}, 0.4).rotation, {0.1, 0.2, 0.3}};
  const Rigid3 camera_from_object = {Rigid3::from_axis_angle({0, 1, 0}, 1.0).rotation, {0, 0.1, 0.8}};
  const Eigen::Vector3d point_in_camera(0.02, 0.1, 0.75);
  made.hypotheses.resize(1);
  made.hypotheses[0].world_from_object = made.world_from_camera * camera_from_object;
  made.hypotheses[0].correspondences.resize(1);
  made.hypotheses[0].correspondences[0].scene_point = (made.world_from_camera * point_in_camera).cast<float>();
  made.hypotheses[0].correspondences[0].scene_normal =
      (made.world_from_camera.rotation * Eigen::Vector3d::UnitX()).cast<float>();
  const Rigid3 other = {Rigid3::from_axis_angle({3, 1, 0}, -0.7).rotation, {-1, 0.5, 0}};
  const std::vector<Hypothesis> moved = move_hypotheses(made, other);
  ASSERT_EQ(moved.size(), 1U);
  EXPECT_LT((moved[0].world_from_object.matrix() - (other * camera_from_object).matrix()).norm(), 1e-12);
  const Correspondence& c = moved[0].correspondences[0];
  EXPECT_LT((c.scene_point.cast<double>() - other * point_in_camera).norm(), 1e-6);
  EXPECT_LT((c.scene_normal.cast<double>() - other.rotation * Eigen::Vector3d::UnitX()).norm(), 1e-6);
}

}  // namespace
}  // namespace resight
