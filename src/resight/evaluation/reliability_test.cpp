// SPDX-License-Identifier: Apache-2.0
#include "resight/evaluation/reliability.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <stdexcept>

namespace resight {
namespace {

int total(const Reliability& reliability) {
  int count = 0;
  for (const ScoreBin& bin : reliability.bins()) count += bin.count();
  return count;
}

TEST(Reliability, ScoresThatHoldHaveNoError) {
  Reliability reliability;
  for (int i = 0; i < 10; ++i) reliability.add(0.8, i < 8);
  for (int i = 0; i < 10; ++i) reliability.add(0.3, i < 3);
  EXPECT_NEAR(reliability.calibration_error(), 0, 1e-12);
}

TEST(Reliability, TheErrorIsTheMeanOverTheDetections) {
  Reliability reliability;
  for (int i = 0; i < 30; ++i) reliability.add(0.8, true);   // 0.2 too low.
  for (int i = 0; i < 10; ++i) reliability.add(0.6, false);  // 0.6 too high.
  EXPECT_NEAR(reliability.calibration_error(), (30 * 0.2 + 10 * 0.6) / 40, 1e-12);
}

TEST(Reliability, EachScoreIsInOneBinAndTheLowerEndIsPartOfIt) {
  Reliability reliability;
  for (const ScoreBin& bin : reliability.bins()) reliability.add(bin.from, true);
  for (const ScoreBin& bin : reliability.bins()) {
    EXPECT_EQ(bin.count(), 1);
    EXPECT_EQ(bin.mean_score(), bin.from);
    EXPECT_EQ(bin.share_right(), 1);
  }
  reliability.add(1.0, false);
  EXPECT_EQ(reliability.bins().back().wrong, 1);
  EXPECT_EQ(total(reliability), static_cast<int>(reliability.bins().size()) + 1);
}

TEST(Reliability, WithoutDetectionsThereIsNoNumber) {
  EXPECT_TRUE(std::isnan(Reliability().calibration_error()));
  EXPECT_TRUE(std::isnan(Reliability().bins()[0].share_right()));
}

TEST(Reliability, WhatIsNoProbabilityIsRefused) {
  Reliability reliability;
  for (const double score : {-0.1, 1.1, std::numeric_limits<double>::quiet_NaN()})
    EXPECT_THROW(reliability.add(score, true), std::invalid_argument) << score;
}

}  // namespace
}  // namespace resight
