// SPDX-License-Identifier: Apache-2.0
#include "resight/verification/hypothesis_score.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "resight/recognition/recognizer_config.hpp"

namespace resight {
namespace {

HypothesisEvidence some_evidence() {
  HypothesisEvidence evidence;
  evidence.accepted = true;
  evidence.fit = 0.8;
  evidence.visible_share = 0.3;
  evidence.num_correspondences = 20;
  evidence.appearance.shared_texture = 2.5;
  evidence.appearance.newest_similarity = 0.75;
  evidence.costs.explained_scene = 500;
  evidence.costs.plane = 125;
  evidence.costs.outlier = 25;  // gains 500 - 125 - 25
  evidence.seen_through_share = 0.1;
  evidence.appearance.silhouette_error = 0.05;
  evidence.appearance.hue_similarity = 0.9;
  return evidence;
}

constexpr HypothesisScoreOptions kSome{.offset = -4,
                                       .gain_weight = 5,
                                       .correspondence_weight = 0.7,
                                       .fit_weight = 2,
                                       .visible_weight = 6,
                                       .texture_weight = 1.5,
                                       .beside_planes_weight = 3,
                                       .newest_weight = 2.5,
                                       .seen_through_weight = 2,
                                       .silhouette_weight = 1.1,
                                       .hue_weight = 6,
                                       .uncolored_weight = 9};

TEST(HypothesisScore, IsTheLogisticOfTheWeightedEvidence) {
  const double log_odds = -4 + 5 * 0.7 + 0.7 * std::log(21.0) + 2 * 0.8 + 6 * std::log(0.01 + 0.3) +
                          1.5 * std::log(1 + 2.5) + 3 * 0.8 + 2.5 * 0.75 - 2 * 0.1 - 1.1 * std::log(0.02 + 0.05) +
                          6 * 0.9;
  EXPECT_NEAR(hypothesis_score(some_evidence(), kSome), 1 / (1 + std::exp(-log_odds)), 1e-12);
}

TEST(HypothesisScore, ColoursThatAreNotComparedAreNoEvidence) {
  HypothesisEvidence evidence = some_evidence();
  evidence.appearance = {.is_compared = false};
  const double log_odds =
      -4 + 5 * 0.7 + 0.7 * std::log(21.0) + 2 * 0.8 + 6 * std::log(0.01 + 0.3) + 3 * 0.8 - 2 * 0.1 + 9;
  EXPECT_NEAR(hypothesis_score(evidence, kSome), 1 / (1 + std::exp(-log_odds)), 1e-12);
}

TEST(HypothesisScore, GrowsWithTheEvidence) {
  for (const char* preset : {"mvr", "mvr-chd", "default"}) {
    const HypothesisScoreOptions options = RecognizerConfig::from_preset(preset).verify.score;
    const double score = hypothesis_score(some_evidence(), options);
    EXPECT_GT(score, 0) << preset;
    EXPECT_LT(score, 1) << preset;
    HypothesisEvidence better = some_evidence();
    better.num_correspondences = 40;
    EXPECT_GT(hypothesis_score(better, options), score) << preset;
    better = some_evidence();
    better.costs.outlier = 0;
    better.fit = 0.9;
    EXPECT_GT(hypothesis_score(better, options), score) << preset;
  }
}

TEST(HypothesisScore, IsFiniteIfNothingIsExplainedOrTheCostIsHigher) {
  HypothesisEvidence evidence = some_evidence();
  evidence.costs.explained_scene = 0;
  const double nothing = hypothesis_score(evidence, kSome);
  evidence.costs.explained_scene = 1e-3;
  evidence.costs.outlier = 1e9;
  const double costly = hypothesis_score(evidence, kSome);
  EXPECT_GT(nothing, costly);
  EXPECT_GT(costly, 0);
}

TEST(HypothesisScore, BadOptionsAreRefused) {
  HypothesisScoreOptions options;
  options.gain_weight = -1;
  EXPECT_THROW(options.check(), std::invalid_argument);
  options = {};
  options.offset = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(options.check(), std::invalid_argument);
}

}  // namespace
}  // namespace resight
