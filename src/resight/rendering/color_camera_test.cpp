// SPDX-License-Identifier: Apache-2.0
#include "resight/rendering/color_camera.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace resight {
namespace {

const Eigen::Vector3f kNoGain = Eigen::Vector3f::Ones();

// Left half dark, right half bright.
LightImage edge_image(float dark = 0.1F, float bright = 0.5F) {
  LightImage light(64, 48, Eigen::Vector3f::Zero());
  for (int v = 0; v < 48; ++v)
    for (int u = 0; u < 64; ++u) light(u, v) = Eigen::Vector3f::Constant(u < 32 ? dark : bright);
  return light;
}

double deviation(const Image<Rgb8>& image, int u0, int u1) {
  double sum = 0, sum_sq = 0, count = 0;
  for (int v = 4; v < image.height() - 4; ++v)
    for (int u = u0; u < u1; ++u) {
      sum += image(u, v).g;
      sum_sq += image(u, v).g * image(u, v).g;
      ++count;
    }
  return std::sqrt(std::max(0.0, sum_sq / count - sum / count * sum / count));
}

ColorCamera everything_on() {
  ColorCamera camera;
  camera.exposure.metering = 0.8;
  camera.exposure.white_balancing = 0.5;
  camera.exposure.red_gain = 1.1;
  camera.blur_px = 0.5;
  camera.motion_blur_px = 1;
  camera.mosaic = true;
  camera.read_noise = 0.01;
  camera.shot_noise = 0.05;
  camera.noise_reduction = 8;
  camera.contrast = 0.3;
  camera.sharpening = 0.8;
  camera.saturation = 1.2;
  camera.jpeg_quality = 80;
  return camera;
}

TEST(ColorCamera, IsTheCurveOfSrgbWhenOff) {
  const Image<Rgb8> image = develop_color(edge_image(), {}, kNoGain, 1);
  EXPECT_EQ(image(0, 0), (Rgb8{89, 89, 89}));  // 1.055 * 0.1^(1/2.4) - 0.055 = 0.349
  EXPECT_EQ(image(63, 0), (Rgb8{188, 188, 188}));
}

TEST(ColorCamera, SharpeningOvershoots) {
  ColorCamera camera;
  camera.sharpening = 1;
  const Image<Rgb8> image = develop_color(edge_image(), camera, kNoGain, 1);
  EXPECT_GT(image(32, 20).g, 188 + 10);
  EXPECT_LT(image(31, 20).g, 89 - 10);
  EXPECT_EQ(image(60, 20).g, 188);
}

TEST(ColorCamera, NoiseFollowsTheLightAndIsReduced) {
  ColorCamera camera;
  camera.shot_noise = 0.05;
  const Image<Rgb8> noisy = develop_color(edge_image(0.02F, 0.6F), camera, kNoGain, 1);
  // sigma of light 0.05 sqrt(x); the curve is steeper in the dark, so both are about as noisy after it.
  EXPECT_GT(deviation(noisy, 2, 30), 4);
  EXPECT_GT(deviation(noisy, 34, 62), 4);
  camera.noise_reduction = 20;
  EXPECT_LT(deviation(develop_color(edge_image(0.02F, 0.6F), camera, kNoGain, 1), 34, 62),
            0.6 * deviation(noisy, 34, 62));
}

TEST(ColorCamera, MosaicKeepsFlatColours) {
  ColorCamera camera;
  camera.mosaic = true;
  LightImage light(16, 16, Eigen::Vector3f::Zero());
  for (Eigen::Vector3f& c : light.data()) c = {0.5F, 0.2F, 0.1F};
  const Image<Rgb8> plain = develop_color(light, {}, kNoGain, 1);
  EXPECT_EQ(develop_color(light, camera, kNoGain, 1), plain);
}

TEST(ColorCamera, MeteringBringsViewsToOneBrightness) {
  ColorCamera camera;
  camera.exposure.metering = 1;
  const Image<Rgb8> dark = develop_color(edge_image(0.02F, 0.1F), camera, kNoGain, 1);
  const Image<Rgb8> bright = develop_color(edge_image(0.1F, 0.5F), camera, kNoGain, 1);
  EXPECT_NEAR(dark(10, 10).g, bright(10, 10).g, 1);
  EXPECT_NEAR(dark(50, 10).g, bright(50, 10).g, 1);
}

TEST(ColorCamera, WhiteBalanceMakesTheMeanGrey) {
  ColorCamera camera;
  camera.exposure.white_balancing = 1;
  LightImage light = edge_image();
  for (Eigen::Vector3f& c : light.data()) c = c.cwiseProduct(Eigen::Vector3f(1.3F, 1, 0.6F));
  const Rgb8 c = develop_color(light, camera, kNoGain, 1)(5, 5);
  EXPECT_NEAR(c.r, c.g, 1);
  EXPECT_NEAR(c.b, c.g, 1);
}

TEST(ColorCamera, CompressionChangesTextureButNotFlatParts) {
  ColorCamera camera;
  camera.jpeg_quality = 50;
  LightImage light = edge_image();
  for (int v = 0; v < 48; ++v)
    for (int u = 40; u < 64; ++u) light(u, v) *= (u * 7 + v * 13) % 5 < 2 ? 0.6F : 1.2F;
  const Image<Rgb8> plain = develop_color(light, {}, kNoGain, 1);
  const Image<Rgb8> compressed = develop_color(light, camera, kNoGain, 1);
  double change = 0;
  for (int v = 0; v < 48; ++v)
    for (int u = 40; u < 64; ++u) change += std::abs(plain(u, v).g - compressed(u, v).g);
  EXPECT_GT(change / (48 * 24), 2);
  EXPECT_LT(change / (48 * 24), 30);
  EXPECT_NEAR(compressed(10, 10).g, plain(10, 10).g, 4);
  camera.jpeg_quality = 99;
  const Image<Rgb8> fine = develop_color(light, camera, kNoGain, 1);
  for (int v = 0; v < 48; ++v)
    for (int u = 0; u < 64; ++u) ASSERT_NEAR(fine(u, v).g, plain(u, v).g, 4) << u << " " << v;
}

TEST(ColorCamera, MotionBlurKeepsTheMeanAndSoftensEdges) {
  ColorCamera camera;
  camera.motion_blur_px = 6;
  const Image<Rgb8> image = develop_color(edge_image(), camera, kNoGain, 5);
  EXPECT_GT(image(31, 20).g, 95);
  EXPECT_LT(image(32, 20).g, 180);
  EXPECT_EQ(image(2, 20).g, 89);
}

TEST(ColorCamera, HasTheSameBytesForAnyNumberOfThreads) {
  const Image<Rgb8> one = develop_color(edge_image(), everything_on(), kNoGain, 3, 1);
  EXPECT_EQ(develop_color(edge_image(), everything_on(), kNoGain, 3, 4), one);
  EXPECT_NE(develop_color(edge_image(), everything_on(), kNoGain, 4, 1), one);
}

TEST(ColorCamera, RejectsInvalidOptions) {
  ColorCamera camera;
  camera.jpeg_quality = 0;
  EXPECT_THROW(static_cast<void>(develop_color(edge_image(), camera, kNoGain, 1)), std::invalid_argument);
}

}  // namespace
}  // namespace resight
