// SPDX-License-Identifier: Apache-2.0
#include "resight/sensor/surface_color.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "resight/core/random.hpp"
#include "resight/sensor/prepared_view.hpp"

namespace resight {
namespace {

constexpr int kWidth = 160;
constexpr int kHeight = 120;
const Camera kCamera{kWidth, kHeight, 500, 500, 79.5, 59.5};

// A slope from left to right with an edge in the middle, and noise.
Image<Rgb8> noisy_image(double sigma, std::uint64_t seed = 1) {
  Rng rng(seed);
  Image<Rgb8> image(kWidth, kHeight);
  for (int v = 0; v < kHeight; ++v)
    for (int u = 0; u < kWidth; ++u) {
      const double light = 60 + 0.4 * u + (u > kWidth / 2 ? 60 : 0);
      const auto level = [&] {
        return static_cast<std::uint8_t>(std::clamp(std::lround(light + sigma * rng.normal()), 0L, 255L));
      };
      image(u, v) = {level(), level(), level()};
    }
  return image;
}

Image<float> at_depth(float z_m) { return Image<float>(kWidth, kHeight, z_m); }

double error_of(const Image<Rgb8>& image) {
  double sum_sq = 0;
  int num = 0;
  for (int v = 10; v < kHeight - 10; ++v)
    for (int u = 10; u < kWidth / 2 - 10; ++u) {
      const double off = image(u, v).g - (60 + 0.4 * u);
      sum_sq += off * off;
      ++num;
    }
  return std::sqrt(sum_sq / num);
}

TEST(SurfaceColor, NoiseIsEstimatedDespiteSlopesAndEdges) {
  EXPECT_LT(estimate_image_noise(noisy_image(0)), 0.5);
  for (const double sigma : {2.0, 4.0, 9.0}) EXPECT_NEAR(estimate_image_noise(noisy_image(sigma)), sigma, 0.1 * sigma);
  EXPECT_EQ(estimate_image_noise(Image<Rgb8>(2, 2)), 0);
  EXPECT_EQ(estimate_image_noise(Image<Rgb8>(40, 40, Rgb8{255, 255, 255})), 0) << "cut off: nothing is known";
}

TEST(SurfaceColor, NoiseIsAveragedToAboutOneGreyLevel) {
  for (const double sigma : {3.0, 5.0}) {
    const Image<Rgb8> averaged = average_over_surface(noisy_image(sigma), kCamera, at_depth(0.3F), 0.005);
    EXPECT_LT(error_of(averaged), 1.3);
    EXPECT_GT(error_of(averaged), 0.5);
  }
}

TEST(SurfaceColor, AnImageWithLittleNoiseStaysAsItIs) {
  const RgbdFrame frame{"view", kCamera, noisy_image(0.6), at_depth(0.3F), {}};
  EXPECT_TRUE(average_over_surface(frame.color, kCamera, frame.depth_m, 0.005).empty());
  PrepareViewOptions averaging;
  averaging.color_width_m = 0.005;
  const PreparedView view = prepare_view(frame, averaging);
  EXPECT_EQ(&view.surface_color(), &view.frame.color);
}

TEST(SurfaceColor, NoMoreThanTheWidthOnTheSurfaceIsAveraged) {
  // At 3 m, a pixel is 6 mm wide.
  const Image<Rgb8> image = noisy_image(9);
  EXPECT_EQ(average_over_surface(image, kCamera, at_depth(3), 0.005), image);
  EXPECT_NE(average_over_surface(image, kCamera, at_depth(3), 0.02), image);
}

TEST(SurfaceColor, TheMeanIsThatOfTheSquareWithinTheImage) {
  const Image<Rgb8> image = noisy_image(9);
  Image<float> z_m = at_depth(1);
  z_m(50, 50) = std::numeric_limits<float>::quiet_NaN();
  const Image<Rgb8> averaged = average_over_surface(image, kCamera, z_m, 0.0085);  // Half of 4.25 px: two around.
  for (const auto& [u, v] : {std::pair{0, 0}, {1, 60}, {159, 119}, {80, 60}}) {
    int sum = 0;
    int num = 0;
    for (int y = std::max(v - 2, 0); y <= std::min(v + 2, kHeight - 1); ++y)
      for (int x = std::max(u - 2, 0); x <= std::min(u + 2, kWidth - 1); ++x) {
        sum += image(x, y).b;
        ++num;
      }
    EXPECT_EQ(averaged(u, v).b, (sum + num / 2) / num) << u << ", " << v;
  }
  EXPECT_EQ(averaged(50, 50), image(50, 50)) << "no depth";
}

TEST(SurfaceColor, SerialIsParallel) {
  const Image<Rgb8> image = noisy_image(5);
  EXPECT_EQ(average_over_surface(image, kCamera, at_depth(0.5F), 0.005, 1),
            average_over_surface(image, kCamera, at_depth(0.5F), 0.005, 4));
}

TEST(SurfaceColor, BadInputIsRefused) {
  EXPECT_THROW((void)average_over_surface(noisy_image(1), kCamera, at_depth(1), 0), std::invalid_argument);
  EXPECT_THROW((void)average_over_surface(Image<Rgb8>(3, 3), kCamera, at_depth(1), 0.005), std::invalid_argument);
}

TEST(SurfaceColor, APreparedViewHasItsOwnColorsIfOff) {
  const RgbdFrame frame{"view", kCamera, noisy_image(5), at_depth(0.5F), {}};
  EXPECT_EQ(prepare_view(frame).surface_color(), frame.color);
  PrepareViewOptions averaging;
  averaging.color_width_m = 0.005;
  const PreparedView averaged = prepare_view(frame, averaging);
  EXPECT_EQ(averaged.frame.color, frame.color);
  EXPECT_LT(error_of(averaged.surface_color()), error_of(frame.color) / 3);
}

}  // namespace
}  // namespace resight
