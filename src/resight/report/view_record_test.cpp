// SPDX-License-Identifier: Apache-2.0
#include "resight/report/view_record.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

#include "resight/report/report_test_scene.hpp"

namespace resight {
namespace {

using namespace resight::test;
using ::testing::ElementsAre;

GroundTruthObject truth_of(const std::string& object, const Rigid3& camera_from_object, double visible_share = 1) {
  GroundTruthObject truth;
  truth.object = object;
  truth.camera_from_object = camera_from_object;
  truth.visible_share = visible_share;
  return truth;
}

TEST(MakeViewRecord, KeepsCountsAndDropsClouds) {
  const RgbdFrame frame = make_frame();
  const SceneUpdate update = make_updates(frame)[1];
  const std::size_t num_removed = update.changes.removed_in_world.size();
  ASSERT_GT(num_removed, 100U);
  const ViewRecord record = make_view_record(frame, make_library(), update);
  EXPECT_EQ(record.num_removed_points, num_removed);
  EXPECT_EQ(record.num_novel_points, 4000U);
  EXPECT_TRUE(record.update.changes.removed_in_world.empty());
  EXPECT_TRUE(record.update.changes.novel_in_world.empty());
  EXPECT_TRUE(record.update.changes.novel_mask.empty());
  EXPECT_TRUE(record.update.changes.removed_mask.empty());
  EXPECT_EQ(record.update.changes.changed_share, 0.125);
  EXPECT_EQ(record.image_id, 1);
  EXPECT_GT(record.picture_jpeg.size(), 1000U);
  EXPECT_FALSE(record.evaluation.has_value());
  EXPECT_THAT(record.marks, ElementsAre(DetectionMark::kUnjudged));
}

TEST(MakeViewRecord, PictureCanBeLeftOut) {
  const RgbdFrame frame = make_frame();
  EXPECT_TRUE(make_view_record(frame, make_library(), make_update(frame, 0), std::nullopt, {.picture = false})
                  .picture_jpeg.empty());
  EXPECT_THROW(
      (void)make_view_record(frame, make_library(), make_update(frame, 0), std::nullopt, {.picture_quality = 0}),
      std::invalid_argument);
}

TEST(EvaluateView, GivesEachDetectionAVerdict) {
  const RgbdFrame frame = make_frame();
  const ModelLibrary library = make_library();
  SceneUpdate update = make_update(frame, 4);
  const Rigid3 old_slab = at(0.2, 0.05, 1.1);
  update.detections = {make_detection(frame, 0, at(0, 0, 1)), make_detection(frame, 1, old_slab),
                       make_detection(frame, 2, at(-0.3, 0, 1)), make_detection(frame, 1, at(0.2, 0.3, 1.2))};
  const std::vector<GroundTruthObject> truth = {truth_of("ball", at(0.02, 0, 1)), truth_of("big_ball", at(0, 0.3, 1)),
                                                truth_of("slab", at(0.2, 0.3, 1.2), 0.01)};
  const std::vector<FormerPlace> places = {{"slab", frame.world_from_camera * old_slab, 3}};
  const ViewEvaluation evaluation =
      evaluate_view(update, {frame.world_from_camera, truth}, places, frame.camera, library);
  EXPECT_EQ(evaluation.matching.score, (RecognitionScore{1, 2, 1}));
  EXPECT_EQ(evaluation.strict_score, (RecognitionScore{0, 3, 2})) << "the ball is 2 cm off";
  ASSERT_EQ(evaluation.ghosts.size(), 1U);
  ASSERT_EQ(evaluation.missed.size(), 1U);
  EXPECT_EQ(evaluation.missed[0].object, "big_ball");

  const ViewRecord record = make_view_record(frame, library, update, evaluation);
  EXPECT_THAT(record.marks, ElementsAre(DetectionMark::kCorrect, DetectionMark::kGhost, DetectionMark::kFalsePositive,
                                        DetectionMark::kIgnored));
  update.detections.clear();
  EXPECT_THROW((void)make_view_record(frame, library, update, evaluation), std::invalid_argument);
}

TEST(EvaluateView, CorrectedPosesLeaveThePlacesOfTheTruth) {
  const RgbdFrame frame = make_frame();
  const Rigid3 corrected = Rigid3::from_translation({0, 0.2, 0}) * frame.world_from_camera;
  SceneUpdate update = make_update(frame, 4);
  update.detections = {make_detection(frame, 1, at(0.2, 0.05, 1.1))};
  update.detections[0].world_from_object = corrected * at(0.2, 0.05, 1.1);
  update.world_from_camera = corrected;
  const std::vector<FormerPlace> places = {{"slab", frame.world_from_camera * at(0.2, 0.05, 1.1), 3}};
  EXPECT_EQ(evaluate_view(update, {frame.world_from_camera, {}}, places, frame.camera, make_library()).ghosts.size(),
            1U);
}

TEST(Summarize, SumsOverViews) {
  ReportRun run = make_run();
  run.views[1].evaluation.emplace();
  run.views[1].evaluation->matching.score = {3, 1, 2};
  run.views[1].evaluation->strict_score = {1, 3, 4};
  run.views[1].evaluation->ghosts.resize(2);
  const RunSummary summary = summarize(run);
  EXPECT_EQ(summary.num_views, 2);
  EXPECT_EQ(summary.num_detections, 3);
  EXPECT_EQ(summary.num_events, 2) << "moved and removed; not the two found objects";
  EXPECT_EQ(summary.num_scored_views, 1);
  EXPECT_EQ(summary.score, (RecognitionScore{3, 1, 2}));
  EXPECT_EQ(summary.strict_score, (RecognitionScore{1, 3, 4}));
  EXPECT_EQ(summary.num_ghosts, 2);
  EXPECT_DOUBLE_EQ(summary.mean_view_wall_s, 0.5);  // 0.25 and 0.75
  EXPECT_DOUBLE_EQ(summary.median_view_wall_s, 0.5);
  ASSERT_EQ(summary.times.stages().size(), 2U);
  EXPECT_DOUBLE_EQ(summary.times.stages()[0].wall_s, 0.5);
}

TEST(Summarize, EmptyRunHasNoTimes) {
  const RunSummary summary = summarize({});
  EXPECT_EQ(summary.num_views, 0);
  EXPECT_TRUE(std::isnan(summary.mean_view_wall_s));
  EXPECT_TRUE(std::isnan(summary.median_view_wall_s));
}

}  // namespace
}  // namespace resight
