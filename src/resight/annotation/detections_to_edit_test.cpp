// SPDX-License-Identifier: Apache-2.0
#include "resight/annotation/detections_to_edit.hpp"

#include <gmock/gmock.h>

#include "resight/annotation/annotated_scene_test.hpp"

namespace resight {
namespace {

/// What a perfect recogniser would have found, in a frame of its own.
RecognitionResults recognise(const test::AnnotatedScene& scene, const Rigid3& own_from_world) {
  RecognitionResults results;
  for (int v = 0; v < scene.num_views(); ++v) {
    StoredView view;
    view.name = scene.view_name(v);
    view.world_from_camera = own_from_world * *scene.read_pose(v);
    for (const auto& [id, object] : scene.document.objects) {
      if (!object.is_in(v)) continue;
      StoredDetection& detection = view.detections.emplace_back();
      detection.object = scene.library.objects[static_cast<std::size_t>(object.object)].name;
      detection.track = object.track;
      detection.score = 1;
      detection.world_from_object = own_from_world * object.world_from_object;
    }
    results.views.push_back(std::move(view));
  }
  for (const auto& [id, object] : scene.document.objects) {
    StoredEvent& event = results.events.emplace_back();
    event.view = object.first_view;
    event.kind = "found";
    event.track = object.track;
  }
  return results;
}

// As with `--poses auto`.
TEST(DetectionsToEdit, TheFrameOfTheResultsMayBeAnother) {
  const test::AnnotatedScene scene;
  const auto edit = detections_to_edit(recognise(scene, scene.read_pose(0)->inverse()), scene, scene.library);
  ASSERT_TRUE(edit.ok()) << edit.error().message;
  ASSERT_EQ(edit->changes.size(), scene.document.objects.size());
  const Rigid3& pose = std::get<PutObject>(edit->changes[0]).object.world_from_object;
  EXPECT_TRUE(pose.translation.isApprox(scene.document.objects.at(0).world_from_object.translation, 1e-6));
}

TEST(DetectionsToEdit, AnotherSequenceWithTheSameNamesIsRefused) {
  const test::AnnotatedScene scene;
  for (const bool is_turn : {false, true}) {
    RecognitionResults results = recognise(scene, Rigid3::identity());
    for (std::size_t v = 0; v < results.views.size(); ++v) {
      EXPECT_EQ(detections_to_edit(results, scene, scene.library).ok(), 2 * v <= results.views.size()) << v;
      Rigid3& pose = results.views[v].world_from_camera;
      if (is_turn)
        pose.rotation *= Eigen::AngleAxisd(0.3, Eigen::Vector3d::UnitZ()).toRotationMatrix();
      else
        pose.translation.z() += 0.2;
    }
    const auto edit = detections_to_edit(results, scene, scene.library);
    ASSERT_FALSE(edit.ok());
    EXPECT_THAT(edit.error().message, testing::HasSubstr("another sequence: its cameras were elsewhere in 6 of 6"));
  }
}

}  // namespace
}  // namespace resight
