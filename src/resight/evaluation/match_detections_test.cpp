// SPDX-License-Identifier: Apache-2.0
#include "resight/evaluation/match_detections.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <numbers>
#include <stdexcept>

#include "resight/core/random.hpp"
#include "resight/evaluation/pose_at_test.hpp"

namespace resight {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

constexpr double kPi = std::numbers::pi;

ObjectModel make_model(const std::string& name, int id) {
  ObjectModel model;
  model.name = name;
  model.bop_id = id;
  return model;
}

/// mug: no symmetry. tin: continuous symmetry about z. book: two-fold symmetry about z. pan: centre 20 cm from its
/// origin.
ModelLibrary library_to_match() {
  ModelLibrary library;
  library.objects = {make_model("mug", 1), make_model("tin", 2), make_model("book", 3), make_model("pan", 4)};
  library.objects[1].symmetries.continuous.push_back({});
  library.objects[2].symmetries.discrete.push_back(Rigid3::from_axis_angle(Eigen::Vector3d::UnitZ(), kPi));
  library.objects[3].center = {0.2F, 0.0F, 0.0F};
  return library;
}

Rigid3 pose_turned(double angle_deg, const Eigen::Vector3d& axis = Eigen::Vector3d::UnitZ()) {
  return Rigid3::from_axis_angle(axis, angle_deg * kPi / 180);
}
GroundTruthObject truth_of(const std::string& object, const Rigid3& pose, double visible_share = 1.0) {
  GroundTruthObject truth;
  truth.object = object;
  truth.camera_from_object = pose;
  truth.visible_share = visible_share;
  return truth;
}
DetectedObject detection_of(const std::string& object, const Rigid3& pose) { return {object, pose, 0.9}; }

MatchDetectionsResult match(const std::vector<GroundTruthObject>& truth, const std::vector<DetectedObject>& detections,
                            const MatchDetectionsOptions& options = {}) {
  return match_detections(truth, detections, library_to_match(), options);
}

TEST(MatchDetections, PerfectDetectionsScoreOne) {
  const auto result =
      match({truth_of("mug", pose_at(0)), truth_of("tin", pose_at(0.3)), truth_of("book", pose_at(-0.3))},
            {detection_of("book", pose_at(-0.3)), detection_of("mug", pose_at(0)), detection_of("tin", pose_at(0.3))});
  EXPECT_EQ(result.score, (RecognitionScore{3, 0, 0}));
  ASSERT_EQ(result.matches.size(), 3U);
  EXPECT_EQ(result.matches[0].truth, 2);
  EXPECT_EQ(result.matches[1].truth, 0);
  EXPECT_NEAR(result.matches[2].difference.center_distance_m, 0, 1e-12);
}

TEST(MatchDetections, NothingDetectedMissesAll) {
  const auto result = match({truth_of("mug", pose_at(0)), truth_of("tin", pose_at(0.3))}, {});
  EXPECT_EQ(result.score, (RecognitionScore{0, 0, 2}));
  EXPECT_THAT(result.false_negatives, ElementsAre(0, 1));
}

TEST(MatchDetections, NothingThereMakesEachDetectionFalse) {
  const auto result = match({}, {detection_of("mug", pose_at(0)), detection_of("mug", pose_at(0))});
  EXPECT_EQ(result.score, (RecognitionScore{0, 2, 0}));
  EXPECT_EQ(match({}, {}).score, RecognitionScore{});
}

TEST(MatchDetections, SwappedIdentitiesCostTwice) {
  const auto result = match({truth_of("mug", pose_at(0)), truth_of("tin", pose_at(0.3))},
                            {detection_of("tin", pose_at(0)), detection_of("mug", pose_at(0.3))});
  EXPECT_EQ(result.score, (RecognitionScore{0, 2, 2}));
}

TEST(MatchDetections, DuplicatesAreFalsePositives) {
  const auto result = match(
      {truth_of("mug", pose_at(0))},
      {detection_of("mug", pose_at(0.02)), detection_of("mug", pose_at(0.001)), detection_of("mug", pose_at(0.01))});
  EXPECT_EQ(result.score, (RecognitionScore{1, 2, 0}));
  EXPECT_EQ(result.matches.at(0).detection, 1) << "the nearest one is the hit";
}

TEST(MatchDetections, LimitsAreInclusiveAndBothHold) {
  const MatchDetectionsOptions options{.max_center_distance_m = 0.0625, .max_rotation_rad = 0.5};
  const std::vector<GroundTruthObject> truth = {truth_of("mug", Rigid3::identity())};
  const auto hits = [&](const Rigid3& pose) {
    return match(truth, {detection_of("mug", pose)}, options).score.true_positives;
  };
  EXPECT_EQ(hits(pose_at(0.0625, 0, 0)), 1);
  EXPECT_EQ(hits(pose_at(0.0626, 0, 0)), 0);
  EXPECT_EQ(hits(Rigid3::from_axis_angle(Eigen::Vector3d::UnitX(), 0.499)), 1);
  EXPECT_EQ(hits(Rigid3::from_axis_angle(Eigen::Vector3d::UnitX(), 0.501)), 0);
}

TEST(MatchDetections, StrictPairIsOneCentimetreAndTenDegrees) {
  const std::vector<GroundTruthObject> truth = {truth_of("mug", pose_at(0))};
  const std::vector<DetectedObject> loose = {detection_of("mug", pose_at(0.011))};
  const std::vector<DetectedObject> turned_far = {detection_of("mug", pose_at(0) * pose_turned(11))};
  const std::vector<DetectedObject> good = {detection_of("mug", pose_at(0.009) * pose_turned(9))};
  EXPECT_EQ(match(truth, loose).score.true_positives, 1);
  EXPECT_EQ(match(truth, loose, strict_match_options()).score, (RecognitionScore{0, 1, 1}));
  EXPECT_EQ(match(truth, turned_far, strict_match_options()).score, (RecognitionScore{0, 1, 1}));
  EXPECT_EQ(match(truth, good, strict_match_options()).score, (RecognitionScore{1, 0, 0}));
}

TEST(MatchDetections, SymmetricFlipsAreRight) {
  const auto hits = [](const std::string& object, const Rigid3& motion) {
    return match({truth_of(object, pose_at(0.1))}, {detection_of(object, pose_at(0.1) * motion)}).score.true_positives;
  };
  EXPECT_EQ(hits("mug", pose_turned(180)), 0);
  EXPECT_EQ(hits("book", pose_turned(180)), 1);
  EXPECT_EQ(hits("book", pose_turned(90)), 0);
  EXPECT_EQ(hits("tin", pose_turned(77)), 1);
  EXPECT_EQ(hits("tin", pose_turned(180, Eigen::Vector3d::UnitX())), 0) << "upside down is another pose";
}

TEST(MatchDetections, ComparesCentresNotOrigins) {
  // A rotation by 20 deg about the pan's centre moves its origin by 7 cm; about its origin, it moves the centre by as
  // much.
  const Rigid3 about_center = pose_at(0.2, 0, 0) * pose_turned(20) * pose_at(-0.2, 0, 0);
  EXPECT_EQ(match({truth_of("pan", pose_at(0))}, {detection_of("pan", pose_at(0) * about_center)}).score.true_positives,
            1);
  EXPECT_EQ(
      match({truth_of("pan", pose_at(0))}, {detection_of("pan", pose_at(0) * pose_turned(20))}).score.true_positives,
      0);
}

TEST(MatchDetections, HiddenTruthIsNeitherHitNorMiss) {
  const std::vector<GroundTruthObject> truth = {truth_of("mug", pose_at(0), 0.04)};
  const auto missed = match(truth, {});
  EXPECT_EQ(missed.score, RecognitionScore{});
  EXPECT_THAT(missed.ignored_truth, ElementsAre(0));
  const auto found = match(truth, {detection_of("mug", pose_at(0))});
  EXPECT_EQ(found.score, RecognitionScore{});
  EXPECT_THAT(found.ignored_detections, ElementsAre(0));
  EXPECT_EQ(match(truth, {detection_of("mug", pose_at(0.2))}).score, (RecognitionScore{0, 1, 0}))
      << "elsewhere it is false";
  EXPECT_EQ(match({truth_of("mug", pose_at(0), 0.05)}, {}).score, (RecognitionScore{0, 0, 1}))
      << "5 % is enough to count";
  EXPECT_EQ(match({truth_of("mug", pose_at(0), std::numeric_limits<double>::quiet_NaN())}, {}).score,
            (RecognitionScore{0, 0, 1}));
}

TEST(MatchDetections, HiddenTruthDoesNotTakeAVisibleOnesDetection) {
  const auto result =
      match({truth_of("mug", pose_at(0.03), 0.01), truth_of("mug", pose_at(0))}, {detection_of("mug", pose_at(0.03))});
  EXPECT_EQ(result.score, (RecognitionScore{1, 0, 0}));
  EXPECT_THAT(result.ignored_detections, IsEmpty());
}

TEST(MatchDetections, TwoOfAKindAreBothFound) {
  // Both detections are near truth 0; a greedy choice of the nearest pair would lose truth 1.
  const auto result = match({truth_of("mug", pose_at(0)), truth_of("mug", pose_at(0.06))},
                            {detection_of("mug", pose_at(0.015)), detection_of("mug", pose_at(-0.03))});
  EXPECT_EQ(result.score, (RecognitionScore{2, 0, 0}));
  EXPECT_EQ(result.matches.at(0).truth, 1);
  EXPECT_EQ(result.matches.at(1).truth, 0);
}

TEST(MatchDetections, OrderOfInputDoesNotMatter) {
  int decisive = 0;
  for (std::uint64_t seed = 1; seed <= 100; ++seed) {
    Rng rng(seed);
    std::vector<GroundTruthObject> truth;
    std::vector<DetectedObject> detections;
    for (int i = 0; i < 5; ++i) {
      const double visible_share = rng.uniform() < 0.2 ? 0.0 : 1.0;
      truth.push_back(truth_of(i % 2 ? "mug" : "tin", pose_at(rng.uniform() * 0.2), visible_share));
      detections.push_back(detection_of(i % 2 ? "mug" : "tin", pose_at(rng.uniform() * 0.2)));
    }
    const RecognitionScore forward = match(truth, detections).score;
    std::reverse(truth.begin(), truth.end());
    std::reverse(detections.begin(), detections.end());
    ASSERT_EQ(match(truth, detections).score, forward) << "seed " << seed;
    decisive += forward.true_positives > 0 && forward.false_positives > 0 ? 1 : 0;
  }
  EXPECT_GT(decisive, 50);
}

TEST(MatchDetections, EachItemIsInOneList) {
  const auto result =
      match({truth_of("mug", pose_at(0)), truth_of("mug", pose_at(0.5), 0.0), truth_of("tin", pose_at(1)),
             truth_of("lamp", pose_at(0))},
            {detection_of("mug", pose_at(0.01)), detection_of("mug", pose_at(0.5)), detection_of("book", pose_at(0))});
  EXPECT_EQ(result.matches.size(), 1U);
  EXPECT_THAT(result.ignored_detections, ElementsAre(1));
  EXPECT_THAT(result.false_positives, ElementsAre(2));
  EXPECT_THAT(result.ignored_truth, ElementsAre(1));
  EXPECT_THAT(result.false_negatives, ElementsAre(2));
  EXPECT_THAT(result.unknown_truth, ElementsAre(3));
}

TEST(MatchDetections, RefusesNonsense) {
  EXPECT_THROW((void)match({}, {detection_of("lamp", pose_at(0))}), std::invalid_argument);
  EXPECT_THROW((void)match({}, {}, {.max_center_distance_m = 0}), std::invalid_argument);
  EXPECT_THROW((void)match({}, {}, {.max_rotation_rad = -1}), std::invalid_argument);
  EXPECT_THROW((void)match({}, {}, {.min_visible_share = 1.5}), std::invalid_argument);
}

}  // namespace
}  // namespace resight
