// SPDX-License-Identifier: Apache-2.0
#include "resight/evaluation/loss.hpp"

#include <gtest/gtest.h>

#include <stdexcept>

namespace resight {
namespace {

const Rigid3 kCameraFromObject = Rigid3::from_translation({0.1, 0, 1});
const Rigid3 kWorldFromCamera =
    Rigid3::from_translation({1, 2, 3}) * Rigid3::from_axis_angle(Eigen::Vector3d::UnitX(), 2.0);

// A mug and a tin, both a 5 cm cube of surface points. The true object is a mug in front of a camera away from the
// origin.
class LossTest : public ::testing::Test {
 protected:
  LossTest() {
    for (const char* name : {"tin", "mug"}) {
      ObjectModel model;
      model.name = name;
      for (int i = 0; i < 6; ++i)
        for (int j = 0; j < 6; ++j)
          for (const double z : {0.0, 0.05})
            model.surface.points.push_back(Eigen::Vector3d(0.01 * i, 0.01 * j, z).cast<float>());
      library_.objects.push_back(model);
    }
    truth_.object = "mug";
    truth_.camera_from_object = kCameraFromObject;
    trace_.correspondences.resize(2);
  }

  [[nodiscard]] Loss loss() const { return find_loss(truth_, kWorldFromCamera, trace_, library_); }

  // By default of the mug (object 1), displaced along x.
  static Hypothesis hypothesis(double offset_m, int object = 1) {
    Hypothesis h;
    h.object = object;
    h.world_from_object = kWorldFromCamera * Rigid3::from_translation({offset_m, 0, 0}) * kCameraFromObject;
    return h;
  }
  void add_verified(double offset_m, double refined_offset_m, bool accepted = false) {
    trace_.verified.push_back(hypothesis(offset_m));
    HypothesisEvidence evidence;
    evidence.accepted = accepted;
    evidence.world_from_object = hypothesis(refined_offset_m).world_from_object;
    evidence.explained_share = offset_m;  // Distinguishes the entries.
    trace_.evidence.push_back(evidence);
  }
  void add_keypoints(int count, double offset_m) {
    for (int i = 0; i < count; ++i)
      trace_.sift.points.push_back((kCameraFromObject * Eigen::Vector3d(0.01 * i - offset_m, 0, 0)).cast<float>());
  }
  void add_correspondences(int count, double error_m) {
    for (int i = 0; i < count; ++i) {
      Correspondence c;
      c.model_point = Eigen::Vector3f(0.01F * static_cast<float>(i), 0, 0);
      c.scene_point = (kCameraFromObject * c.model_point.cast<double>() + Eigen::Vector3d(0, 0, error_m)).cast<float>();
      trace_.correspondences[1].push_back(c);
    }
  }

  ModelLibrary library_;
  GroundTruthObject truth_;
  RecognitionTrace trace_;
};

TEST_F(LossTest, NothingSeenIsNoKeypoints) {
  EXPECT_EQ(loss().stage, LossStage::kNoKeypoints);
  EXPECT_FALSE(loss().best.has_value());
  EXPECT_FALSE(loss().evidence.has_value());
  EXPECT_EQ(loss().verified, -1);
}

TEST_F(LossTest, KeypointsAwayFromTheSurfaceDoNotCount) {
  add_keypoints(6, 0.03);  // Three of the six lie beside the object, two of them farther than 1 cm.
  EXPECT_EQ(loss().num_keypoints, 4);
  EXPECT_EQ(loss().stage, LossStage::kNoKeypoints);
}

TEST_F(LossTest, KeypointsWithoutRightCorrespondencesAreNoMatches) {
  add_keypoints(6, 0);
  add_correspondences(10, 0.02);
  const Loss found = loss();
  EXPECT_EQ(found.stage, LossStage::kNoMatches);
  EXPECT_EQ(found.num_keypoints, 6);
  EXPECT_EQ(found.num_correspondences, 10);
  EXPECT_EQ(found.num_right, 0);
}

TEST_F(LossTest, RightCorrespondencesWithoutHypothesisAreNoGroup) {
  add_keypoints(6, 0);
  add_correspondences(5, 0.009);
  EXPECT_EQ(loss().num_right, 5);
  EXPECT_EQ(loss().stage, LossStage::kNoGroup);
  trace_.merged = {hypothesis(0.3), hypothesis(0, 0)};  // One is far away, one is another object at the place.
  EXPECT_EQ(loss().stage, LossStage::kNoGroup);
  EXPECT_NEAR(loss().best->center_distance_m, 0.3, 1e-9);
}

TEST_F(LossTest, AHypothesisBesideItIsWrongPose) {
  trace_.merged = {hypothesis(0.3), hypothesis(-0.08)};
  EXPECT_EQ(loss().stage, LossStage::kWrongPose);
  EXPECT_NEAR(loss().best->center_distance_m, 0.08, 1e-9);
}

TEST_F(LossTest, ARightHypothesisIsLostWhereItIsSeenLast) {
  trace_.merged = {hypothesis(0.01)};
  trace_.clustered = {hypothesis(0.09)};
  EXPECT_EQ(loss().stage, LossStage::kClusteredOut);
  trace_.clustered.push_back(hypothesis(0.02));
  EXPECT_EQ(loss().stage, LossStage::kCalledAbsent);
  EXPECT_NEAR(loss().best->center_distance_m, 0.02, 1e-9);
  add_verified(0.03, 0.09);
  EXPECT_EQ(loss().stage, LossStage::kRefinedAway);
  EXPECT_NEAR(loss().best->center_distance_m, 0.09, 1e-9);
  add_verified(0.04, 0.005);
  EXPECT_EQ(loss().stage, LossStage::kRejected);
  EXPECT_NEAR(loss().best->center_distance_m, 0.005, 1e-9);
  EXPECT_EQ(loss().evidence->explained_share, 0.04);
  EXPECT_EQ(loss().verified, 1);
}

TEST_F(LossTest, RefinementMayBringARightOneThatWasNone) {
  add_verified(0.2, 0.01);
  EXPECT_EQ(loss().stage, LossStage::kRejected);
}

TEST_F(LossTest, WhatWasAcceptedIsAnotherObjects) {
  add_verified(0.04, 0.04, true);
  trace_.clustered = trace_.merged = trace_.verified;
  EXPECT_EQ(loss().stage, LossStage::kCalledAbsent);
  add_verified(0.01, 0.01);
  EXPECT_EQ(loss().stage, LossStage::kRejected);
  EXPECT_EQ(loss().evidence->explained_share, 0.01);
}

TEST_F(LossTest, WhatWasAcceptedAtAWrongPoseIsRefinedAway) {
  add_verified(0.3, 0.02);
  trace_.evidence.back().world_from_object.translation.x() += 1;
  add_verified(0.03, 0.09, true);
  trace_.clustered = trace_.merged = trace_.verified;
  EXPECT_EQ(loss().stage, LossStage::kRefinedAway);
  EXPECT_NEAR(loss().best->center_distance_m, 0.09, 1e-9);
  EXPECT_TRUE(loss().evidence->accepted);
}

TEST_F(LossTest, AnObjectThatIsNotInTheLibraryIsRefused) {
  truth_.object = "teapot";
  EXPECT_THROW((void)loss(), std::invalid_argument);
}

TEST(LossStageNames, AreDistinct) {
  for (int a = 0; a <= static_cast<int>(LossStage::kRejected); ++a)
    for (int b = 0; b < a; ++b)
      EXPECT_STRNE(to_string(static_cast<LossStage>(a)), to_string(static_cast<LossStage>(b)));
}

}  // namespace
}  // namespace resight
