// SPDX-License-Identifier: Apache-2.0
#include "resight/recognition/recognize_sequence.hpp"

#include <gtest/gtest.h>

#include "resight/recognition/box_scene_test_util.hpp"
#include "resight/sensor/testing/ball_scene.hpp"
#include "resight/sensor/testing/memory_sequence.hpp"

namespace resight {
namespace {

using test::BoxScene;
using test::MemorySequence;

// The box is gone in the third and last view: its removal still waits for a further view.
std::vector<RgbdFrame> frames_of(const BoxScene& scene) {
  std::vector<RgbdFrame> frames;
  for (int v = 0; v < 2; ++v) frames.push_back(render(scene.world, scene.cameras[static_cast<std::size_t>(v)]).frame);
  frames.push_back(render(analytic::World{}, scene.cameras[2]).frame);
  return frames;
}

TEST(RecognizeSequence, TheLastViewReportsTheEventsThatWereWaiting) {
  const BoxScene scene;
  const std::vector<RgbdFrame> frames = frames_of(scene);
  SceneRecognizer by_hand(scene.library, scene.config, scene.store);
  std::vector<std::vector<ObjectEvent>> expected;
  for (const RgbdFrame& frame : frames) expected.push_back(by_hand.add_view(frame).events);
  const std::vector<ObjectEvent> waiting = by_hand.finish();
  ASSERT_EQ(waiting.size(), 1U);
  EXPECT_EQ(waiting[0].kind, ObjectEventKind::kRemoved);

  SceneRecognizer recognizer(scene.library, scene.config, scene.store);
  std::vector<SceneUpdate> updates;
  const auto events =
      recognize_sequence(recognizer, MemorySequence(frames), [&](const RgbdFrame& frame, SceneUpdate& update) {
        EXPECT_EQ(frame.world_from_camera.translation, scene.cameras[updates.size()].translation);
        updates.push_back(std::move(update));
      });
  ASSERT_TRUE(events.ok());
  ASSERT_EQ(events->size(), frames.size());
  ASSERT_EQ(updates.size(), frames.size());
  for (std::size_t v = 0; v < frames.size(); ++v) {
    const std::size_t num_waiting = v + 1 == frames.size() ? 1U : 0U;
    EXPECT_EQ((*events)[v].size(), expected[v].size() + num_waiting) << v;
    EXPECT_EQ(updates[v].events.size(), (*events)[v].size()) << v << ": no event was superseded";
  }
  EXPECT_EQ(events->back().back().kind, ObjectEventKind::kRemoved);
  EXPECT_TRUE(recognizer.finish().empty()) << "finished already";
}

TEST(RecognizeSequence, TheTraceIsThatOfEachView) {
  const BoxScene scene;
  SceneRecognizer recognizer(scene.library, scene.config, scene.store);
  RecognitionTrace trace;
  trace.correspondences.resize(7);
  std::vector<std::size_t> num_merged;
  ASSERT_TRUE(recognize_sequence(
                  recognizer, MemorySequence(frames_of(scene)),
                  [&](const RgbdFrame&, SceneUpdate& update) {
                    EXPECT_EQ(trace.merged.size(), static_cast<std::size_t>(update.counts.merged)) << update.view;
                    EXPECT_TRUE(trace.correspondences.empty()) << update.view;
                    num_merged.push_back(trace.merged.size());
                  },
                  &trace)
                  .ok());
  EXPECT_EQ(num_merged.size(), 3U);
}

// Mean distance of the floor from its true height; of the points near it.
double floor_error_m(const PointCloud& cloud_in_world) {
  double sum_m = 0;
  int count = 0;
  for (const Eigen::Vector3f& p : cloud_in_world.points)
    if (std::abs(p.z()) < 0.06F && p.y() < 0.7F) sum_m += p.z(), ++count;
  return std::abs(sum_m) / count;
}

TEST(RecognizeSequence, DepthIsCorrectedByTheBiasOfItsViews) {
  const BoxScene scene;
  const auto reconstruct = [&](bool correct, DepthBias& bias) {
    RecognizerConfig config = scene.config;
    config.camera.depth_bias.correct = correct;
    SceneRecognizer recognizer(scene.library, config);
    const auto events =
        recognize_sequence(recognizer, MemorySequence(test::render_biased_views(0.02)),
                           [&](const RgbdFrame&, SceneUpdate& update) { bias = update.camera_errors.depth_bias; });
    EXPECT_TRUE(events.ok());
    return floor_error_m(recognizer.reconstruction());
  };
  DepthBias corrected, uncorrected;
  EXPECT_LT(reconstruct(true, corrected), 0.005);
  EXPECT_TRUE(corrected.is_significant());
  EXPECT_GT(reconstruct(false, uncorrected), 0.015);
  EXPECT_EQ(uncorrected.num_views, 0);
}

TEST(RecognizeSequence, StopsAtAViewThatCannotBeRead) {
  const BoxScene scene;
  std::vector<RgbdFrame> frames = frames_of(scene);
  frames[1] = {};
  SceneRecognizer recognizer(scene.library, scene.config, scene.store);
  int num_views = 0;
  const auto events =
      recognize_sequence(recognizer, MemorySequence(frames), [&](const RgbdFrame&, SceneUpdate&) { ++num_views; });
  ASSERT_FALSE(events.ok());
  EXPECT_EQ(events.error().message, "view 1 cannot be read");
  EXPECT_EQ(num_views, 1);
}

TEST(RecognizeViews, GivesTheEventsOfTheSequence) {
  const BoxScene scene;
  const std::vector<RgbdFrame> frames = frames_of(scene);
  SceneRecognizer of_sequence(scene.library, scene.config, scene.store);
  const auto expected = recognize_sequence(of_sequence, MemorySequence(frames));
  SceneRecognizer recognizer(scene.library, scene.config, scene.store);
  std::size_t next = 0, num_reported = 0;
  const auto events = recognize_views(
      recognizer, [&] { return Result(next < frames.size() ? std::optional(frames[next++]) : std::nullopt); },
      [&](const RgbdFrame&, SceneUpdate& update) { num_reported += update.events.size(); });
  ASSERT_TRUE(events.ok());
  ASSERT_EQ(events->size(), frames.size());
  std::size_t num_events = 0;
  for (std::size_t v = 0; v < frames.size(); ++v) {
    EXPECT_EQ((*events)[v].size(), (*expected)[v].size()) << v;
    num_events += (*events)[v].size();
  }
  EXPECT_EQ(num_reported + 1, num_events) << "the removal waits for a view that does not come";
  EXPECT_EQ(events->back().back().kind, ObjectEventKind::kRemoved);
}

TEST(RecognizeViews, StopsWithTheErrorOfTheSource) {
  const BoxScene scene;
  SceneRecognizer recognizer(scene.library, scene.config, scene.store);
  const auto events = recognize_views(recognizer, [] { return Result<std::optional<RgbdFrame>>(Error{"no camera"}); });
  ASSERT_FALSE(events.ok());
  EXPECT_EQ(events.error().message, "no camera");
}

TEST(RecognizeSequence, WithoutViewsThereAreNoEvents) {
  const BoxScene scene;
  SceneRecognizer recognizer(scene.library, scene.config, scene.store);
  EXPECT_TRUE(recognize_sequence(recognizer, MemorySequence({})).value().empty());
}

}  // namespace
}  // namespace resight
