// SPDX-License-Identifier: Apache-2.0
#include "resight/appearance/photometric_fit.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "resight/core/random.hpp"

namespace resight {
namespace {

// Random colours on a sphere, and the same colours under another light.
struct Pairs {
  std::vector<Eigen::Vector3f> model, scene, normals;
};

Pairs make_pairs(const PhotometricFit& light, int count, float wrong_share = 0) {
  Rng rng(7);
  const auto draw = [&](double low, double high) { return static_cast<float>(rng.uniform(low, high)); };
  Pairs pairs;
  for (int i = 0; i < count; ++i) {
    pairs.normals.push_back(Eigen::Vector3f(draw(-1, 1), draw(-1, 1), draw(-1, 0.2)).normalized());
    pairs.model.emplace_back(draw(0.1, 0.5), draw(0.1, 0.5), draw(0.1, 0.5));
    const bool is_wrong = draw(0, 1) < wrong_share;
    pairs.scene.push_back(is_wrong ? Eigen::Vector3f(draw(0.05, 0.9), draw(0.05, 0.9), draw(0.05, 0.9))
                                   : light(pairs.model.back(), pairs.normals.back()));
  }
  return pairs;
}

const PhotometricFit kLamp{{0.35F, 0.25F, 0.15F}, {0.02F, 0.0F, 0.05F}, {0.2F, -0.1F, -0.25F}, 0};

// Root mean square error in log units.
double rms_error(const PhotometricFit& fit, const Pairs& pairs) {
  double sum = 0;
  for (std::size_t i = 0; i < pairs.model.size(); ++i) {
    const Eigen::Array3f expected = kLamp(pairs.model[i], pairs.normals[i]).array().log();
    sum += (fit(pairs.model[i], pairs.normals[i]).array().log() - expected).square().mean();
  }
  return std::sqrt(sum / static_cast<double>(pairs.model.size()));
}

TEST(FitPhotometry, FindsExposureWhiteBalanceOffsetAndShading) {
  const Pairs pairs = make_pairs(kLamp, 300);
  EXPECT_LT(rms_error(fit_photometry(pairs.model, pairs.scene, pairs.normals, {}), pairs), 0.05);
}

TEST(FitPhotometry, IsNotLedAstrayByAThirdOfWrongPairs) {
  const Pairs pairs = make_pairs(kLamp, 1000, 0.33F);
  EXPECT_LT(rms_error(fit_photometry(pairs.model, pairs.scene, pairs.normals, {}), pairs), 0.1);
}

TEST(FitPhotometry, StaysWithinWhatLightCanDo) {
  const std::vector<Eigen::Vector3f> black(100, {0.01F, 0.01F, 0.01F});
  const std::vector<Eigen::Vector3f> white(100, {0.9F, 0.9F, 0.9F});
  const PhotometricLimits limits;
  EXPECT_NEAR(fit_photometry(black, white, {}, limits).log_gain.mean(), limits.max_log_exposure, 1e-5);
}

TEST(LimitChroma, AGreenCanIsNoGreyOne) {
  const std::vector<Eigen::Vector3f> green(100, {0.1F, 0.5F, 0.1F});
  const std::vector<Eigen::Vector3f> grey(100, {0.25F, 0.25F, 0.25F});
  const PhotometricLimits limits;
  const PhotometricFit fit = limit_chromaticity(fit_photometry(green, grey, {}, limits), Eigen::Array3f::Zero());
  EXPECT_LE(fit.chroma().abs().maxCoeff(), 2 * kMaxLogChroma);
  const Eigen::Vector3f seen = fit(green[0], Eigen::Vector3f::Zero());
  EXPECT_GT(seen.y(), 1.5F * seen.x());
}

// A camera that saturates colours shows no blue on a yellow object. That makes it no darker.
TEST(LimitChroma, ADimChannelDoesNotSetTheExposure) {
  const std::vector<Eigen::Vector3f> yellow(100, {0.6F, 0.45F, 0.03F});
  const std::vector<Eigen::Vector3f> saturated(100, {0.6F, 0.45F, 0.001F});
  const PhotometricFit fit = limit_chromaticity(fit_photometry(yellow, saturated, {}, {}), Eigen::Array3f::Zero());
  const Eigen::Vector3f seen = fit(yellow[0], Eigen::Vector3f::Zero());
  EXPECT_NEAR(seen.x(), 0.6F, 0.06F);
  EXPECT_NEAR(seen.y(), 0.45F, 0.05F);
  EXPECT_LT(seen.z(), 0.031F);
}

TEST(LimitChroma, APlainColorInTheSameLightStaysTheSame) {
  std::vector<Eigen::Vector3f> yellow;
  for (int i = 0; i < 100; ++i) yellow.emplace_back(0.46F + 1e-6F * static_cast<float>(i % 3), 0.4F, 0.045F);
  const PhotometricFit fit = limit_chromaticity(fit_photometry(yellow, yellow, {}, {}), Eigen::Array3f::Zero());
  EXPECT_TRUE(fit(yellow[0], Eigen::Vector3f::Zero()).isApprox(yellow[0], 1e-3F));
}

// Red, orange and white print, of which the camera's contrast curve brightens the orange and darkens the white: the
// line through them must not turn red into pink.
TEST(FitPhotometry, DarkPairsOfAChannelCountMost) {
  std::vector<Eigen::Vector3f> model;
  std::vector<Eigen::Vector3f> scene;
  for (int i = 0; i < 100; ++i) {
    const Eigen::Vector2f green = i % 10 < 4   ? Eigen::Vector2f(0.005F, 0.005F)
                                  : i % 10 < 7 ? Eigen::Vector2f(0.1F, 0.16F)
                                               : Eigen::Vector2f(0.4F, 0.3F);
    model.emplace_back(0.4F, green.x(), green.x());
    scene.emplace_back(0.4F, green.y(), green.y());
  }
  EXPECT_LT(fit_photometry(model, scene, {}, {})(model[0], Eigen::Vector3f::Zero()).y(), 0.022F);
}

TEST(FindWhiteBalance, IsTheMedianAndNotLedByAWrongFit) {
  const PhotometricFit blue{
      {-0.3F, 0.0F, 0.3F}, Eigen::Array3f::Zero(), Eigen::Vector3f::Zero(), 100, Eigen::Array3f::Ones()};
  const PhotometricFit wrong{
      {0.9F, 0.0F, -0.9F}, Eigen::Array3f::Zero(), Eigen::Vector3f::Zero(), 100, Eigen::Array3f::Ones()};
  const PhotometricFit none;
  const std::vector<PhotometricFit> fits{blue, wrong, none, blue, wrong, wrong};
  const std::vector<float> votes{900, 300, 1e6F, 900, 300, 300};
  EXPECT_TRUE(find_white_balance(fits, votes).isApprox(blue.chroma()));
  const std::vector<float> weak{3, 3, 3, 3, 3, 3};
  EXPECT_TRUE((find_white_balance(fits, weak) == 0).all());
  EXPECT_TRUE(find_white_balance(std::vector{blue}, std::vector{50.0F}).isApprox(blue.chroma()));
  EXPECT_NEAR(find_white_balance(std::vector{wrong}, std::vector{1e4F}).abs().maxCoeff(), kMaxLogWhiteBalance, 1e-6);
  EXPECT_TRUE((find_white_balance({}, {}) == 0).all());
}

TEST(FindWhiteBalance, AYellowObjectDoesNotTellHowBlueTheLightIs) {
  const std::vector<Eigen::Vector3f> yellow(100, {0.4F, 0.4F, 0.02F});
  const std::vector<Eigen::Vector3f> darker(100, {0.4F, 0.4F, 0.005F});
  const std::vector<Eigen::Vector3f> white(100, {0.4F, 0.4F, 0.4F});
  const PhotometricLimits limits;
  const std::vector<PhotometricFit> fits{fit_photometry(yellow, darker, {}, limits),
                                         fit_photometry(white, white, {}, limits)};
  EXPECT_GT(fits[0].chroma().abs().maxCoeff(), 0.3F);
  EXPECT_FLOAT_EQ(fits[1].model_light.minCoeff(), 0.401F);
  const std::vector<float> votes{9000, 900};
  EXPECT_LT(find_white_balance(fits, votes).abs().maxCoeff(), 0.01F);
}

TEST(FitPhotometry, OneNormalLeavesTheShadingOpen) {
  Pairs pairs = make_pairs(kLamp, 200);
  for (std::size_t i = 0; i < pairs.model.size(); ++i) {
    pairs.normals[i] = Eigen::Vector3f::UnitZ();
    pairs.scene[i] = kLamp(pairs.model[i], pairs.normals[i]);
  }
  const PhotometricFit fit = fit_photometry(pairs.model, pairs.scene, pairs.normals, {});
  EXPECT_LT(rms_error(fit, pairs), 0.05);
  EXPECT_LT(fit.shading.head<2>().norm(), 1e-3);
}

TEST(FitPhotometry, LeavesFewPairsAlone) {
  const Pairs pairs = make_pairs(kLamp, 9);
  const PhotometricFit fit = fit_photometry(pairs.model, pairs.scene, pairs.normals, {});
  EXPECT_TRUE((fit.log_gain == 0).all());
  EXPECT_EQ(fit.shading, Eigen::Vector3f::Zero());
}

}  // namespace
}  // namespace resight
