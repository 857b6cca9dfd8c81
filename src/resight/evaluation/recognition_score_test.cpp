// SPDX-License-Identifier: Apache-2.0
#include "resight/evaluation/recognition_score.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace resight {
namespace {

TEST(RecognitionScore, RatiosFollowTheirDefinitions) {
  const RecognitionScore score{.true_positives = 6, .false_positives = 2, .false_negatives = 4};
  EXPECT_DOUBLE_EQ(score.precision(), 0.75);
  EXPECT_DOUBLE_EQ(score.recall(), 0.6);
  const double p = score.precision();
  const double r = score.recall();
  EXPECT_NEAR(score.f_score(), 2 * p * r / (p + r), 1e-12);
}

TEST(RecognitionScore, SumsCountsBeforeRatios) {
  RecognitionScore sum{.true_positives = 1, .false_positives = 0, .false_negatives = 0};  // P = 1
  sum += {.true_positives = 1, .false_positives = 9, .false_negatives = 3};               // P = 0.1
  EXPECT_EQ(sum, (RecognitionScore{2, 9, 3}));
  EXPECT_DOUBLE_EQ(sum.precision(), 2.0 / 11.0) << "the mean of the ratios would be 0.55";
}

TEST(RecognitionScore, NothingToDivideByIsNaN) {
  EXPECT_TRUE(std::isnan(RecognitionScore{}.precision()));
  EXPECT_TRUE(std::isnan(RecognitionScore{}.recall()));
  EXPECT_TRUE(std::isnan(RecognitionScore{}.f_score()));
  const RecognitionScore blind{.true_positives = 0, .false_positives = 0, .false_negatives = 3};
  EXPECT_TRUE(std::isnan(blind.precision()));
  EXPECT_EQ(blind.recall(), 0);
  EXPECT_EQ(blind.f_score(), 0);
}

}  // namespace
}  // namespace resight
