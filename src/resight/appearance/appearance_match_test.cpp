// SPDX-License-Identifier: Apache-2.0
#include "resight/appearance/appearance_match.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

#include "resight/appearance/pattern_similarity.hpp"
#include "resight/core/random.hpp"

namespace resight {
namespace {

std::vector<LabColor> random_colors(int count, std::uint64_t seed) {
  Rng rng(seed);
  std::vector<LabColor> colors;
  const auto next = [&] { return static_cast<float>(rng.uniform(-0.8, 0.8)); };
  for (int i = 0; i < count; ++i) colors.push_back({next(), next(), next()});
  return colors;
}

TEST(ColorPairs, AreFittedAndAdaptedToTheLightOfTheScene) {
  Rng rng(1);
  ColorPairs pairs;
  for (int i = 0; i < 200; ++i) {
    const Eigen::Vector3f color{static_cast<float>(rng.uniform(0.1, 0.6)), static_cast<float>(rng.uniform(0.1, 0.6)),
                                static_cast<float>(rng.uniform(0.1, 0.6))};
    pairs.model.push_back(color);
    pairs.scene.push_back(1.4F * color);
  }
  const PhotometricFit fit = fit_photometry(pairs, {});
  EXPECT_NEAR(fit.log_gain.mean(), std::log(1.4), 0.02);
  const std::vector<LabColor> adapted = adapt_colors(pairs, fit);
  const std::vector<LabColor> seen = to_lab(pairs.scene);
  ASSERT_EQ(adapted.size(), seen.size());
  for (std::size_t i = 0; i < seen.size(); ++i) EXPECT_NEAR(adapted[i].l, seen[i].l, 0.02);
  EXPECT_EQ(count_color_inliers(adapted, seen, 0.8, {}), 200);
  EXPECT_TRUE(adapt_colors({}, fit).empty());
}

TEST(ColorPairs, ShadeByTheirNormals) {
  PhotometricFit fit;
  fit.shading = {0, 0, 0.4F};
  const ColorPairs pairs{.model = {{0.3F, 0.3F, 0.3F}, {0.3F, 0.3F, 0.3F}},
                         .normals = {Eigen::Vector3f::UnitZ(), -Eigen::Vector3f::UnitZ()}};
  const std::vector<LabColor> adapted = adapt_colors(pairs, fit);
  EXPECT_GT(adapted[0].l, adapted[1].l + 0.1F);
}

TEST(CountColorInliers, AgreesWithTheFormulaColourByColour) {
  const AppearanceOptions options{.sigma_l = 0.3, .sigma_ab = 0.1, .sigma_saturation = 0.5};
  const std::vector<LabColor> a = random_colors(500, 2), b = random_colors(500, 3);
  int last = 500;
  for (const double min_similarity : {0.001, 0.1, 0.5, 0.8}) {
    int expected = 0;
    for (std::size_t i = 0; i < a.size(); ++i) {
      const double dl = a[i].l - b[i].l, da = a[i].a - b[i].a, db = a[i].b - b[i].b;
      const double exponent =
          dl * dl / (4 * 0.3 * 0.3) + (da * da + db * db) / (4 * (0.01 + 0.25 * (a[i].a * a[i].a + a[i].b * a[i].b)));
      expected += std::exp(-exponent) > min_similarity ? 1 : 0;
    }
    EXPECT_EQ(count_color_inliers(a, b, min_similarity, options), expected);
    EXPECT_LE(expected, last);
    last = expected;
  }
  EXPECT_THROW((void)count_color_inliers(a, {}, 0.5, options), std::invalid_argument);
}

TEST(MatchTexture, SharesNoMoreThanTheModelHas) {
  const AppearanceOptions options;
  const std::vector<LabColor> texture = random_colors(300, 4);
  const std::vector<LabColor> plain(300, LabColor{0.2F, 0.1F, 0});
  const TextureMatch same = match_texture(texture, texture, texture, options);
  EXPECT_NEAR(same.similarity, 1, 1e-9);
  EXPECT_EQ(same.shared_texture, same.texture_contrast);
  EXPECT_EQ(same.texture_contrast, match_patterns(texture, texture, options.chroma_weight).shared_texture);
  // An untextured model that shading makes uneven, in the model's colours and in the scene.
  const TextureMatch shaded = match_texture(plain, texture, texture, options);
  EXPECT_NEAR(shaded.similarity, 1, 1e-9);
  EXPECT_EQ(shaded.shared_texture, 0);
}

}  // namespace
}  // namespace resight
