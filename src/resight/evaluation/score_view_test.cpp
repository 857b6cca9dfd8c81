// SPDX-License-Identifier: Apache-2.0
#include "resight/evaluation/score_view.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "resight/evaluation/out_of_image.hpp"
#include "resight/evaluation/pose_at_test.hpp"

namespace resight {
namespace {

ModelLibrary make_library() {
  ModelLibrary library;
  library.objects.resize(3);
  library.objects[0].name = "mug";
  library.objects[1].name = "soup";
  library.objects[2].name = "can";
  library.objects[2].symmetries.continuous.push_back({});  // About z.
  return library;
}

Rigid3 turned(const Rigid3& pose, double deg) {
  return pose * Rigid3::from_axis_angle(Eigen::Vector3d::UnitZ(), deg * std::numbers::pi / 180);
}

GroundTruthObject object(const std::string& name, const Rigid3& pose, double visible_share = 1.0, int instance = 0) {
  GroundTruthObject o;
  o.object = name;
  o.instance = instance;
  o.camera_from_object = pose;
  o.visible_share = visible_share;
  return o;
}

EvaluatedView score(const std::vector<GroundTruthObject>& truth, const std::vector<DetectedObject>& detections,
                    const std::vector<FormerPlace>& places = {}) {
  return score_view(5, {Rigid3::identity(), truth}, detections, places, make_kinect_camera(), make_library());
}

TEST(ScoreView, PerfectIsAllFoundAtBothTolerances) {
  const EvaluatedView view = score({object("mug", pose_at(0)), object("soup", pose_at(0.3))},
                                   {{"mug", pose_at(0), 0.9}, {"soup", turned(pose_at(0.304), 3), 0.8}});
  EXPECT_EQ(view.score, (RecognitionScore{2, 0, 0}));
  EXPECT_EQ(view.strict_score, (RecognitionScore{2, 0, 0}));
  ASSERT_EQ(view.truth.size(), 2U);
  EXPECT_TRUE(view.truth[1].found && view.truth[1].found_strictly);
  EXPECT_NEAR(view.truth[1].center_error_m, 0.004, 1e-9);
  EXPECT_NEAR(view.truth[1].rotation_error_rad, 3 * std::numbers::pi / 180, 1e-9);
  EXPECT_NEAR(view.truth[1].distance_m, std::hypot(0.3, 1.0), 1e-9);
  EXPECT_EQ(view.detections[0].verdict, DetectionVerdict::kCorrect);
}

TEST(ScoreView, NothingReportedIsAllMissed) {
  const EvaluatedView view = score({object("mug", pose_at(0)), object("soup", pose_at(0.3))}, {});
  EXPECT_EQ(view.score, (RecognitionScore{0, 0, 2}));
  EXPECT_EQ(view.strict_score, (RecognitionScore{0, 0, 2}));
  EXPECT_TRUE(std::isnan(view.truth[0].center_error_m));
}

TEST(ScoreView, BetweenTheTolerances) {
  const EvaluatedView view = score({object("mug", pose_at(0))}, {{"mug", pose_at(0.02), 1}});
  EXPECT_EQ(view.score, (RecognitionScore{1, 0, 0}));
  EXPECT_EQ(view.strict_score, (RecognitionScore{0, 1, 1}));
  EXPECT_TRUE(view.truth[0].found);
  EXPECT_FALSE(view.truth[0].found_strictly);
}

TEST(ScoreView, SwappedIdentitiesCostTwice) {
  const EvaluatedView view = score({object("mug", pose_at(0)), object("soup", pose_at(0.3))},
                                   {{"soup", pose_at(0), 1}, {"mug", pose_at(0.3), 1}});
  EXPECT_EQ(view.score, (RecognitionScore{0, 2, 2}));
}

TEST(ScoreView, ASecondDetectionOfOneObjectIsWrong) {
  const EvaluatedView view =
      score({object("mug", pose_at(0))}, {{"mug", pose_at(0.01), 0.9}, {"mug", pose_at(0), 0.2}});
  EXPECT_EQ(view.score, (RecognitionScore{1, 1, 0}));
  EXPECT_EQ(view.detections[1].verdict, DetectionVerdict::kCorrect);  // The nearer one.
  EXPECT_EQ(view.detections[0].verdict, DetectionVerdict::kFalsePositive);
}

TEST(ScoreView, RotationsAboutASymmetryAxisAreFree) {
  EXPECT_EQ(score({object("can", pose_at(0))}, {{"can", turned(pose_at(0), 137), 1}}).strict_score,
            (RecognitionScore{1, 0, 0}));
  EXPECT_EQ(score({object("mug", pose_at(0))}, {{"mug", turned(pose_at(0), 137), 1}}).score,
            (RecognitionScore{0, 1, 1}));
}

TEST(ScoreView, HiddenTruthIsNeitherHitNorMiss) {
  const EvaluatedView view =
      score({object("mug", pose_at(0), 0.04), object("soup", pose_at(0.3), 0.04)}, {{"mug", pose_at(0), 1}});
  EXPECT_EQ(view.score, (RecognitionScore{0, 0, 0}));
  EXPECT_EQ(view.detections[0].verdict, DetectionVerdict::kIgnored);
  EXPECT_FALSE(view.truth[0].counts);
  EXPECT_FALSE(view.truth[1].counts);
}

TEST(ScoreView, TwoOfAKindAreTwo) {
  const std::vector<GroundTruthObject> twins{object("mug", pose_at(0)), object("mug", pose_at(0.3), 1, 1)};
  EXPECT_EQ(score(twins, {{"mug", pose_at(0.3), 1}, {"mug", pose_at(0), 1}}).score, (RecognitionScore{2, 0, 0}));
  const EvaluatedView one = score(twins, {{"mug", pose_at(0.3), 1}});
  EXPECT_EQ(one.score, (RecognitionScore{1, 0, 1}));
  EXPECT_FALSE(one.truth[0].found);
  EXPECT_TRUE(one.truth[1].found);
}

TEST(ScoreView, TruthOfUnknownObjectsIsLeftOutAndMixesNothingUp) {
  const EvaluatedView view = score({object("stranger", pose_at(-0.3)), object("mug", pose_at(0)),
                                    object("stranger", pose_at(0.1)), object("soup", pose_at(0.3))},
                                   {{"soup", pose_at(0.3), 1}});
  EXPECT_EQ(view.score, (RecognitionScore{1, 0, 1}));
  ASSERT_EQ(view.truth.size(), 2U);
  EXPECT_EQ(view.truth[1].object, "soup");
  EXPECT_TRUE(view.truth[1].found);
}

// The Kinect covers +-0.61 m at a distance of 1 m.
TEST(ScoreView, ObjectsOutsideTheImageAreNotScored) {
  const EvaluatedView view =
      score({object("mug", pose_at(0))}, {{"mug", pose_at(0), 1}, {"soup", pose_at(0.7), 1}, {"can", pose_at(0.5), 1}});
  EXPECT_EQ(view.score, (RecognitionScore{1, 1, 0}));
  EXPECT_EQ(view.strict_score, (RecognitionScore{1, 1, 0}));
  EXPECT_EQ(view.detections[1].verdict, DetectionVerdict::kIgnored);
  EXPECT_EQ(view.detections[2].verdict, DetectionVerdict::kFalsePositive);
}

TEST(ShareInImage, CountsSurfacePointsWithinTheBorder) {
  ObjectModel model;
  for (int i = 0; i < 10; ++i) model.surface.points.emplace_back(0.01F * static_cast<float>(i), 0.0F, 0.0F);
  // The right border is at x = 320 / 525 = 0.6095 m: of 0.56 to 0.65 m, the first five are inside.
  EXPECT_DOUBLE_EQ(share_in_image(model, pose_at(0.56), make_kinect_camera()), 0.5);
  EXPECT_EQ(share_in_image(model, pose_at(0), make_kinect_camera()), 1.0);
  EXPECT_EQ(share_in_image(model, Rigid3::from_translation({0, 0, -1}), make_kinect_camera()), 0.0);
}

TEST(ScoreView, ADetectionAtAPlaceLeftIsAGhost) {
  const std::vector<FormerPlace> left{{"mug", pose_at(0), 3}};
  const EvaluatedView view =
      score({object("soup", pose_at(0.3))}, {{"mug", pose_at(0.01), 1}, {"mug", pose_at(-0.3), 1}}, left);
  EXPECT_EQ(view.detections[0].verdict, DetectionVerdict::kGhost);
  EXPECT_EQ(view.detections[1].verdict, DetectionVerdict::kFalsePositive);
  EXPECT_EQ(view.score, (RecognitionScore{0, 2, 1}));
}

}  // namespace
}  // namespace resight
