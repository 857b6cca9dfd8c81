// SPDX-License-Identifier: Apache-2.0
#include "resight/verification/surface_blur.hpp"

#include <gtest/gtest.h>

#include <stdexcept>

#include "resight/appearance/pattern_similarity.hpp"
#include "resight/core/random.hpp"
#include "resight/verification/square_test_util.hpp"

namespace resight {
namespace {

using test::kSide;
using test::square;

// `stripe_points`: width of its stripes; 0: one colour.
std::vector<LabColor> colors(int stripe_points, double noise, std::uint64_t seed) {
  Rng rng(seed);
  std::vector<LabColor> result;
  for (int i = 0; i < kSide * kSide; ++i) {
    const float stripe = stripe_points > 0 && i % kSide / stripe_points % 2 == 1 ? 0.8F : 0;
    const auto off = [&] { return static_cast<float>(noise * rng.normal()); };
    result.push_back({stripe + off(), off(), off()});
  }
  return result;
}

double similarity(const std::vector<LabColor>& a, const std::vector<LabColor>& b, std::optional<double> radius_m) {
  AppearanceOptions options;
  options.pattern_radius_m = radius_m;
  return match_surface_texture(square(), a, a, b, options).similarity;
}

TEST(SurfaceBlur, AveragesTheColorsWithinTheRadius) {
  const std::vector<Eigen::Vector3f> points{{0, 0, 0}, {0.01F, 0, 0}, {0.05F, 0, 0}};
  const std::vector<LabColor> seen{{1, 0, 0.2F}, {0, 1, 0.4F}, {0.5F, 0.5F, 0}};
  const std::vector<LabColor> blurred = SurfaceBlur(points, 0.015)(seen);
  EXPECT_FLOAT_EQ(blurred[0].l, 0.5F);
  EXPECT_FLOAT_EQ(blurred[0].a, 0.5F);
  EXPECT_FLOAT_EQ(blurred[1].b, 0.3F);
  EXPECT_FLOAT_EQ(blurred[2].l, 0.5F);  // By itself.
  EXPECT_THROW((void)SurfaceBlur(points, 0.015)(std::vector<LabColor>(2)), std::invalid_argument);
}

TEST(MatchSurfaceTexture, NoiseOnAPlainSurfaceIsNoPattern) {
  const auto model = colors(0, 0, 1);
  const auto noisy = colors(0, 0.15, 2);
  EXPECT_LT(similarity(model, noisy, std::nullopt), 0.5);
  EXPECT_GT(similarity(model, noisy, 0.015), 0.85);
}

TEST(MatchSurfaceTexture, WideStripesStayAPattern) {
  const auto model = colors(0, 0, 1);
  const auto striped = colors(8, 0.15, 2);
  EXPECT_LT(similarity(model, striped, 0.015), 0.5);
}

TEST(MatchSurfaceTexture, LightThatChangesSlowlyIsNoPattern) {
  const auto model = colors(0, 0, 1);
  auto lit_from_one_side = model;
  for (int i = 0; i < kSide * kSide; ++i)
    lit_from_one_side[static_cast<std::size_t>(i)].l = 0.05F * static_cast<float>(i % kSide);
  EXPECT_LT(similarity(model, lit_from_one_side, std::nullopt), 0.5);
  EXPECT_GT(similarity(model, lit_from_one_side, 0.015), 0.75);
}

TEST(MatchSurfaceTexture, TexturedModelsAreComparedInFull) {
  const auto model = colors(8, 0, 1);
  const auto noisy = colors(8, 0.15, 2);
  EXPECT_EQ(similarity(model, noisy, 0.015), similarity(model, noisy, std::nullopt));
}

TEST(MatchSurfaceTexture, WithoutRadiusItIsThatOfTheColors) {
  const auto a = colors(3, 0.1, 1);
  const auto b = colors(3, 0.1, 2);
  EXPECT_EQ(similarity(a, b, std::nullopt), pattern_similarity(a, b, AppearanceOptions{}.chroma_weight));
}

}  // namespace
}  // namespace resight
