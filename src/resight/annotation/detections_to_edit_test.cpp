// SPDX-License-Identifier: Apache-2.0
#include "resight/annotation/detections_to_edit.hpp"

#include <gmock/gmock.h>

#include <array>

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

/// What a view shows of the one object of run_with_one_object(): nothing if its track is -1.
struct Seen {
  int track = -1;
  double x_m = 0;
};

/// Poses of detections and cameras are off by as much.
const Rigid3 kOwnFromWorld = Rigid3::from_translation({0.05, 0, 0});

void add_detection(const test::AnnotatedScene& scene, const Seen& seen, StoredView& view) {
  StoredDetection& detection = view.detections.emplace_back();
  detection.object = scene.library.objects[0].name;
  detection.track = seen.track;
  detection.score = 1;
  detection.world_from_object = kOwnFromWorld * Rigid3::from_translation({seen.x_m, 0, 0.8});
}

RecognitionResults run_with_one_object(const test::AnnotatedScene& scene, const std::vector<Seen>& seen,
                                       const std::vector<StoredEvent>& events) {
  RecognitionResults results;
  for (std::size_t v = 0; v < seen.size(); ++v) {
    StoredView& view = results.views.emplace_back();
    view.name = scene.view_name(static_cast<int>(v));
    view.world_from_camera = kOwnFromWorld * *scene.read_pose(static_cast<int>(v));
    if (seen[v].track >= 0) add_detection(scene, seen[v], view);
  }
  for (StoredEvent event : events) {
    event.object = scene.library.objects[0].name;
    const auto v = static_cast<std::size_t>(event.view);
    if (event.kind == "moved") event.world_from_object_after = results.views[v].detections[0].world_from_object;
    results.events.push_back(event);
  }
  return results;
}

StoredEvent make_event(int view, const char* kind, int track) {
  StoredEvent event;
  event.view = view;
  event.kind = kind;
  event.track = track;
  return event;
}

/// Track, first and last view of each placement.
std::vector<std::array<int, 3>> list_placements(const RecognitionResults& results, const test::AnnotatedScene& scene) {
  const auto edit = detections_to_edit(results, scene, scene.library);
  EXPECT_TRUE(edit.ok());
  std::vector<std::array<int, 3>> placements;
  for (const AnnotationChange& change : edit->changes) {
    const AnnotatedObject& object = std::get<PutObject>(change).object;
    placements.push_back({object.track, object.first_view, object.last_view});
  }
  return placements;
}

// Track 4 came at view 2. At view 4, track 1 was seen to have left: it had moved.
TEST(DetectionsToEdit, AMoveBeginsWhereTheSecondTrackDoes) {
  const test::AnnotatedScene scene;
  const RecognitionResults results =
      run_with_one_object(scene, {{1, 0}, {1, 0}, {4, 0.2}, {4, 0.2}, {1, 0.2}, {1, 0.2}},
                          {make_event(0, "found", 1), make_event(3, "still_there", 4), make_event(4, "moved", 1)});
  EXPECT_THAT(list_placements(results, scene), testing::ElementsAre(std::array{0, 0, 1}, std::array{0, 2, 5}));
}

// Track 1 was still detected at the old place while track 4 was there: the object had moved nevertheless.
TEST(DetectionsToEdit, AMoveBeginsWhereTheSecondTrackDoesAlsoIfTheFirstOneGoesOn) {
  const test::AnnotatedScene scene;
  for (const std::vector<int>& overlap : {std::vector{2}, {3}, {2, 3}}) {
    RecognitionResults results =
        run_with_one_object(scene, {{1, 0}, {1, 0}, {4, 0.2}, {4, 0.2}, {1, 0.2}, {1, 0.2}},
                            {make_event(0, "found", 1), make_event(3, "still_there", 4), make_event(4, "moved", 1)});
    for (const int view : overlap)
      add_detection(scene, {.track = 1, .x_m = 0}, results.views[static_cast<std::size_t>(view)]);
    EXPECT_THAT(list_placements(results, scene), testing::ElementsAre(std::array{0, 0, 1}, std::array{0, 2, 5}))
        << testing::PrintToString(overlap);
  }
}

TEST(DetectionsToEdit, AnObjectThatWasPutBackHadLeft) {
  const test::AnnotatedScene scene;
  const RecognitionResults results =
      run_with_one_object(scene, {{1, 0}, {1, 0}, {-1, 0}, {-1, 0}, {1, 0}, {1, 0}},
                          {make_event(0, "found", 1), make_event(2, "removed", 1), make_event(4, "added", 1)});
  EXPECT_THAT(list_placements(results, scene), testing::ElementsAre(std::array{0, 0, 1}, std::array{0, 4, 5}));
}

// It was found in view 1, so it has been there from the first view on, although it was added later.
TEST(DetectionsToEdit, TheFirstEventTellsTheBeginning) {
  const test::AnnotatedScene scene;
  const RecognitionResults results = run_with_one_object(
      scene, {{-1, 0}, {1, 0}, {-1, 0}, {1, 0.2}, {-1, 0}, {-1, 0}},
      {make_event(1, "found", 1), make_event(2, "removed", 1), make_event(3, "added", 1), make_event(5, "removed", 1)});
  EXPECT_THAT(list_placements(results, scene), testing::ElementsAre(std::array{0, 0, 1}, std::array{0, 3, 4}));
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
