// SPDX-License-Identifier: Apache-2.0
#include "resight/verification/hue_similarity.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <stdexcept>

#include "resight/verification/square_test_util.hpp"

namespace resight {
namespace {

using test::kSide;
using test::kSpacing_m;
using test::square;

constexpr double kCube_m = 0.015;

AppearanceOptions options_of_cubes() {
  AppearanceOptions options;
  options.pattern_radius_m = kCube_m;
  options.sigma_ab = 0.1;
  return options;
}

LabColor color_of(double hue_rad, double chroma) {
  return {0, static_cast<float>(chroma * std::cos(hue_rad)), static_cast<float>(chroma * std::sin(hue_rad))};
}

// Stripes of two hues, `stripe_points` wide, moved by `offset_points`.
std::vector<LabColor> stripes(double turn_rad, double chroma, int stripe_points = 5, int offset_points = 0) {
  std::vector<LabColor> colors;
  for (int i = 0; i < kSide * kSide; ++i) {
    const bool second = (i % kSide + offset_points) / stripe_points % 2 == 1;
    colors.push_back(color_of(turn_rad + (second ? 1.5 : 0), chroma));
  }
  return colors;
}

double similarity(const std::vector<LabColor>& expected, const std::vector<LabColor>& seen) {
  return hue_similarity(square(), expected, seen, options_of_cubes());
}

TEST(HueSimilarity, SaturationDoesNotCount) { EXPECT_NEAR(similarity(stripes(0, 0.5), stripes(0, 0.25)), 1, 1e-6); }

TEST(HueSimilarity, IsTheCosineOfTheTurnOfSaturatedHues) {
  const std::vector<LabColor> known(kSide * kSide, color_of(0.3, 0.5));
  for (const double turn : {0.2, 0.5, 1.0, std::numbers::pi}) {
    const std::vector<LabColor> seen(kSide * kSide, color_of(0.3 + turn, 0.5));
    const double expected = (0.01 + 0.25 * std::cos(turn)) / (0.01 + 0.25);
    EXPECT_NEAR(similarity(known, seen), expected, 1e-5) << turn << " rad";
  }
}

TEST(HueSimilarity, GreyHasNoHue) {
  EXPECT_GT(similarity(stripes(0, 0.02), stripes(std::numbers::pi, 0.02)), 0.9);
  EXPECT_GT(similarity(stripes(0, 0.5), stripes(0, 0)), 0.99);
}

TEST(HueSimilarity, CubesExcuseAnOffset) {
  AppearanceOptions points_alone = options_of_cubes();
  points_alone.pattern_radius_m = 0.5 * kSpacing_m;
  const auto fine = stripes(0, 0.5, 2), beside = stripes(0, 0.5, 2, 1);
  EXPECT_NEAR(hue_similarity(square(), fine, beside, points_alone), 0.5, 0.1);  // Half of the points change stripes.
  EXPECT_GT(similarity(fine, beside), 0.85);
  EXPECT_LT(similarity(fine, stripes(0.8, 0.5, 2)), 0.75);
}

TEST(HueSimilarity, NothingToCompareIsNoContradiction) {
  EXPECT_EQ(hue_similarity({}, {}, {}, options_of_cubes()), 1);
  AppearanceOptions without_cubes = options_of_cubes();
  without_cubes.pattern_radius_m.reset();
  EXPECT_EQ(hue_similarity(square(), stripes(0, 0.5), stripes(2, 0.5), without_cubes), 1);
  EXPECT_THROW((void)similarity(stripes(0, 0.5), std::vector<LabColor>(3)), std::invalid_argument);
}

}  // namespace
}  // namespace resight
