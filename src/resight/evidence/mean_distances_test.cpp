// SPDX-License-Identifier: Apache-2.0
#include "resight/evidence/mean_distances.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "resight/core/random.hpp"

namespace resight {
namespace {

constexpr int kGridWidth = 320, kGridHeight = 240;  // Squares of 9 x 9 pixels.

/// Noise with a standard deviation of 1, and an offset in the middle.
Image<float> make_distances(float offset) {
  Rng rng(1);
  Image<float> distances(kGridWidth, kGridHeight);
  for (int v = 0; v < kGridHeight; ++v)
    for (int u = 0; u < kGridWidth; ++u)
      distances(u, v) = static_cast<float>(rng.normal()) + (std::hypot(u - 160, v - 120) < 30 ? offset : 0);
  return distances;
}

TEST(MeanDistances, NoiseAveragesOut) {
  // Of 81 pixels: a ninth of the noise remains.
  EXPECT_NEAR(MeanDistances(make_distances(1), 10).at(160, 120), 9, 1.5);
  EXPECT_NEAR(MeanDistances(make_distances(-1), 10).at(160, 120), -9, 1.5);
  EXPECT_LT(std::abs(MeanDistances(make_distances(1), 10).at(40, 40)), 3);
}

TEST(MeanDistances, AnErrorOfThePosesCountsAsNoise) {
  Image<float> tilted = make_distances(1);
  for (int v = 0; v < kGridHeight; ++v)
    for (int u = 0; u < kGridWidth; ++u) tilted(u, v) += static_cast<float>(u - 160) / 80;
  EXPECT_LT(MeanDistances(tilted, 10).at(160, 120), 1.5);
}

TEST(MeanDistances, WhatIsFarAndWhatIsMissingDoesNotCount) {
  const float expected = MeanDistances(make_distances(1), 10).at(160, 120);
  Image<float> distances = make_distances(1);
  for (int v = 0; v < kGridHeight; ++v)
    for (int u = 162; u < 180; ++u) distances(u, v) = v % 2 == 0 ? std::numeric_limits<float>::quiet_NaN() : 20;
  EXPECT_NEAR(MeanDistances(distances, 10).at(160, 120), expected, 1.5);
  for (int v = 118; v < 122; ++v)
    for (int u = 158; u < 162; ++u) distances(u, v) = std::numeric_limits<float>::quiet_NaN();
  EXPECT_TRUE(std::isnan(MeanDistances(distances, 10).at(160, 120))) << "less than half of the square is left";
}

// As of depth that repeats, or that has no noise.
TEST(MeanDistances, TheDeviationIsAtLeastThatOfIndependentNoise) {
  Image<float> distances(kGridWidth, kGridHeight);
  EXPECT_EQ(MeanDistances(distances, 10).at(160, 120), 0);
  for (int v = 110; v < 130; ++v)
    for (int u = 150; u < 170; ++u) distances(u, v) = 0.1F;
  EXPECT_NEAR(MeanDistances(distances, 10).at(160, 120), 0.9, 0.1);
}

TEST(MeanDistances, SmallAndEmptyImagesSayNothing) {
  EXPECT_TRUE(std::isnan(MeanDistances(Image<float>(3, 2), 1).at(1, 1)));
  EXPECT_TRUE(std::isnan(
      MeanDistances(Image<float>(kGridWidth, kGridHeight, std::numeric_limits<float>::quiet_NaN()), 1).at(160, 120)));
}

}  // namespace
}  // namespace resight
