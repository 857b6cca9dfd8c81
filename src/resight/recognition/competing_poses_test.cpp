// SPDX-License-Identifier: Apache-2.0
#include "resight/recognition/competing_poses.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <numbers>

#include "resight/core/odds.hpp"
#include "resight/models/testing/square_world.hpp"

namespace resight {
namespace {

class CompetingPosesTest : public ::testing::Test {
 protected:
  CompetingPosesTest() {
    library_.objects = {test::make_plate("a"), test::make_plate("b")};
    add({.score = 0.9, .yaw_deg = 0});
  }
  struct Candidate {
    double score = 0;
    double yaw_deg = 0;
    double x_m = 0;
    double similarity = 1;
    int object = 0;
    int suppressed_by = 0;
  };
  // The first is accepted.
  void add(const Candidate& candidate) {
    Hypothesis& hypothesis = verified_.hypotheses.emplace_back();
    hypothesis.object = candidate.object;
    HypothesisEvidence& evidence = verified_.evidence.emplace_back();
    evidence.score = candidate.score;
    evidence.fit = 0.9;
    evidence.costs.explained_scene = 1000;
    evidence.appearance.pattern_similarity = candidate.similarity;
    evidence.accepted = verified_.evidence.size() == 1;
    evidence.suppressed_by = evidence.accepted ? -1 : candidate.suppressed_by;
    evidence.world_from_object.translation.x() = candidate.x_m;
    evidence.world_from_object.rotation =
        Eigen::AngleAxisd(candidate.yaw_deg * std::numbers::pi / 180, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  }
  PlaceScore score() const { return score_place(verified_, 0, library_); }
  void expect_alone() const {
    EXPECT_EQ(score().place, 0.9);
    EXPECT_EQ(score().pose, 1);
  }

  ModelLibrary library_;
  VerifiedHypotheses verified_;
};

TEST_F(CompetingPosesTest, AloneItsScoreStays) { expect_alone(); }

TEST_F(CompetingPosesTest, TwoEqualPosesShareTheProbability) {
  add({.score = 0.9, .yaw_deg = 90});
  EXPECT_NEAR(score().place, 18. / 19, 1e-12);
  EXPECT_NEAR(score().pose, 0.5, 1e-12);
}

// Of exclusive poses with independent evidence, by enumeration: none is right, or one of them.
TEST_F(CompetingPosesTest, AreExclusive) {
  const double scores[] = {0.9, 0.6, 0.2};
  add({.score = scores[1], .yaw_deg = 60});
  add({.score = scores[2], .yaw_deg = -60});
  const double none = (1 - scores[0]) * (1 - scores[1]) * (1 - scores[2]);
  double only[3];
  for (int i = 0; i < 3; ++i) only[i] = none * odds_of(scores[i]);
  const double any = only[0] + only[1] + only[2];
  EXPECT_NEAR(score().place, any / (any + none), 1e-12);
  EXPECT_NEAR(score().place * score().pose, only[0] / (any + none), 1e-12);
}

TEST_F(CompetingPosesTest, NearPosesDoNotCompete) {
  add({.score = 0.8, .yaw_deg = 25});
  add({.score = 0.8, .x_m = 0.04});
  expect_alone();
}

TEST_F(CompetingPosesTest, TwoNearEachOtherCountOnce) {
  add({.score = 0.5, .yaw_deg = 80});
  add({.score = 0.9, .yaw_deg = 90});
  EXPECT_NEAR(score().pose, 0.5, 1e-12);
}

TEST_F(CompetingPosesTest, SymmetricPosesDoNotCompete) {
  library_.objects[0].symmetries.discrete.push_back(
      Rigid3::from_rotation(Eigen::AngleAxisd(std::numbers::pi, Eigen::Vector3d::UnitZ()).toRotationMatrix()));
  add({.score = 0.9, .yaw_deg = 180});
  expect_alone();
}

TEST_F(CompetingPosesTest, OtherObjectsAndWhatOthersSuppressDoNotCompete) {
  add({.score = 0.9, .yaw_deg = 90, .similarity = 0.98, .object = 1});
  add({.score = 0.9, .yaw_deg = 90, .suppressed_by = 1});
  add({.score = 0.9, .yaw_deg = 90, .suppressed_by = -1});
  expect_alone();
}

TEST_F(CompetingPosesTest, TwinsShareTheProbability) {
  add({.score = 0.9, .object = 1});
  add({.score = 0.8, .yaw_deg = 90, .object = 1});
  EXPECT_NEAR(score().place, 18. / 19, 1e-12);
  EXPECT_NEAR(score().pose, 0.5, 1e-12);
}

TEST_F(CompetingPosesTest, ScoresOfZeroAndOneAreDefined) {
  add({.score = 1, .yaw_deg = 90});
  EXPECT_NEAR(score().place * score().pose, 0, 1e-9);
  verified_.evidence[0].score = 0;
  verified_.evidence[1].score = 0;
  EXPECT_EQ(score().place * score().pose, 0);
}

}  // namespace
}  // namespace resight
