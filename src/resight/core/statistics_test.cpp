// SPDX-License-Identifier: Apache-2.0
#include "resight/core/statistics.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "resight/core/random.hpp"

namespace resight {
namespace {

TEST(UpperMedian, IsTheMiddleValue) {
  EXPECT_EQ(upper_median(std::vector<double>{3, 1, 2}), 2);
  EXPECT_EQ(upper_median(std::vector<float>{4, 1, 3, 2}), 3) << "the upper one of two";
  EXPECT_EQ(upper_median(std::vector<double>{7}), 7);
  EXPECT_TRUE(std::isnan(upper_median(std::vector<double>{})));
}

TEST(UpperMedian, NormalizedDeviationIsThatOfANormalDistribution) {
  Rng rng(1);
  std::vector<double> deviations;
  for (int i = 0; i < 20001; ++i) deviations.push_back(std::abs(2 * rng.normal()));
  EXPECT_NEAR(kNormalizedMad * upper_median(deviations), 2, 0.05);
}

}  // namespace
}  // namespace resight
