// SPDX-License-Identifier: Apache-2.0
#include "resight/appearance/pattern_similarity.hpp"

#include <gtest/gtest.h>

#include <stdexcept>
#include <vector>

#include "resight/core/random.hpp"

namespace resight {
namespace {

std::vector<LabColor> texture(std::uint64_t seed, double contrast, std::size_t count = 2000) {
  Rng rng(seed);
  const auto draw = [&](double width) { return static_cast<float>(rng.uniform(-width, width)); };
  std::vector<LabColor> colors;
  for (std::size_t i = 0; i < count; ++i)
    colors.push_back({draw(contrast), draw(0.3 * contrast), draw(0.3 * contrast)});
  return colors;
}

std::vector<LabColor> brighter(std::vector<LabColor> colors, float by) {
  for (LabColor& c : colors) c.l += by;
  return colors;
}

TEST(PatternSimilarity, ExposureDoesNotCount) {
  const auto pattern = texture(1, 0.8);
  EXPECT_NEAR(pattern_similarity(pattern, pattern, 2), 1, 1e-9);
  EXPECT_NEAR(pattern_similarity(pattern, brighter(pattern, -0.5F), 2), 1, 1e-5);
}

TEST(PatternSimilarity, UnrelatedTexturesDiffer) {
  EXPECT_LT(pattern_similarity(texture(1, 0.8), texture(2, 0.8), 2), 0.15);
}

TEST(PatternSimilarity, TextureDiffersFromNoTextureBothWays) {
  const auto pattern = texture(1, 0.8);
  const std::vector<LabColor> uniform(pattern.size(), LabColor{0.1F, 0, 0});
  EXPECT_LT(pattern_similarity(pattern, uniform, 2), 0.2);
  EXPECT_DOUBLE_EQ(pattern_similarity(uniform, pattern, 2), pattern_similarity(pattern, uniform, 2));
}

TEST(PatternSimilarity, UntexturedSurfacesAgreeDespiteNoise) {
  EXPECT_GT(pattern_similarity(texture(1, 0.1), texture(2, 0.1), 2), 0.8);
}

TEST(PatternSimilarity, SimilarityFallsAsTextureFades) {
  const auto pattern = texture(1, 0.8);
  double last = 1;
  for (const double contrast : {0.6, 0.4, 0.2}) {
    const double similarity = pattern_similarity(pattern, texture(1, contrast), 2);
    EXPECT_LT(similarity, last - 0.02);
    last = similarity;
  }
}

TEST(MatchPatterns, OnlySimilarTexturesShareContrast) {
  const auto pattern = texture(1, 0.8);
  const std::vector<LabColor> uniform(pattern.size(), LabColor{0.1F, 0, 0});
  const PatternMatch alike = match_patterns(pattern, brighter(pattern, 0.2F), 2);
  // Variance of a uniform texture: 0.8^2 / 3 in lightness, plus that in chromaticity.
  EXPECT_GT(alike.shared_texture, 3);
  EXPECT_NEAR(match_patterns(pattern, texture(1, 0.4), 2).shared_texture, 0.5 * alike.shared_texture, 1e-4);
  EXPECT_LT(match_patterns(pattern, texture(2, 0.8), 2).shared_texture, 0.3);
  EXPECT_EQ(match_patterns(pattern, uniform, 2).shared_texture, 0);
  EXPECT_EQ(match_patterns({}, {}, 2).shared_texture, 0);
}

TEST(PatternSimilarity, NothingSpeaksAgainstNoPairs) { EXPECT_EQ(pattern_similarity({}, {}, 2), 1); }

TEST(PatternSimilarity, RefusesPatternsOfDifferentSize) {
  EXPECT_THROW((void)pattern_similarity(texture(1, 1, 10), texture(1, 1, 9), 2), std::invalid_argument);
}

}  // namespace
}  // namespace resight
