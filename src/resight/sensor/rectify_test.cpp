// SPDX-License-Identifier: Apache-2.0
#include "resight/sensor/rectify.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

namespace resight {
namespace {

constexpr float kMissing = std::numeric_limits<float>::quiet_NaN();
const Camera kSmallCamera{64, 48, 60, 60, 31.5, 23.5};

TEST(Undistort, NoDistortionChangesNothing) {
  const Image<float> depth(64, 48, 1.5F);
  EXPECT_EQ(undistort_depth(depth, kSmallCamera, {}), depth);
}

// A straight line in the world is straight in the ideal image: draw it through the lens, then undistort.
TEST(Undistort, StraightLinesBecomeStraight) {
  const std::vector<double> k = {0.25, 0.05, 0.002, -0.001};
  const LensDistortion lens = *LensDistortion::make("plumb_bob", k);
  Image<float> depth(64, 48, kMissing);
  Image<Rgb8> color(64, 48);
  for (int v = 4; v < 44; ++v)
    for (double u = 39.6; u < 40.4; u += 0.1) {
      const auto bent = lens.distort({(u - 31.5) / 60, (v - 23.5) / 60});
      const auto pixel = kSmallCamera.pixel_at({60 * bent->x() + 31.5, 60 * bent->y() + 23.5});
      if (!pixel) continue;
      depth(pixel->u, pixel->v) = 2;
      color(pixel->u, pixel->v) = {255, 255, 255};
    }
  const Image<float> ideal = undistort_depth(depth, kSmallCamera, lens);
  const Image<Rgb8> ideal_color = undistort_color(color, kSmallCamera, lens);
  int num_on_line = 0;
  for (int v = 8; v < 40; ++v) {
    num_on_line += std::isnan(ideal(40, v)) ? 0 : 1;
    EXPECT_GT(ideal_color(40, v).g, 60) << v;
    for (int u = 0; u < 64; ++u) EXPECT_TRUE(std::abs(u - 40) <= 1 || std::isnan(ideal(u, v))) << u << " " << v;
  }
  EXPECT_GT(num_on_line, 25);
}

TEST(RegisterDepth, SameCameraIsTheIdentity) {
  Image<float> depth(64, 48, 1.0F);
  depth(3, 4) = kMissing;
  const Image<float> registered = register_depth(depth, kSmallCamera, {}, kSmallCamera);
  EXPECT_EQ(registered(10, 10), 1.0F);
  EXPECT_TRUE(std::isnan(registered(3, 4))) << "a hole stays a hole";
}

// A near square before a wall, seen by a colour camera 5 cm to the right and with twice the resolution.
TEST(RegisterDepth, NearSurfacesHideFarOnes) {
  Image<float> depth(64, 48, 2.0F);
  for (int v = 16; v < 32; ++v)
    for (int u = 24; u < 40; ++u) depth(u, v) = 1;
  const Camera color{128, 96, 120, 120, 63.5, 47.5};
  const Rigid3 color_from_depth = Rigid3::from_translation({-0.05, 0, 0});
  const Image<float> registered = register_depth(depth, kSmallCamera, color_from_depth, color);
  // Pixel (32, 24) of the square is at x = 0.5/60 m: u = 63.5 + 120 (x - 0.05).
  EXPECT_EQ(registered(58, 48), 1.0F);
  EXPECT_EQ(registered(110, 48), 2.0F) << "the wall, without gaps at the higher resolution";
  EXPECT_EQ(registered(111, 49), 2.0F);
  int num_holes = 0;
  for (int u = 60; u < 90; ++u) num_holes += std::isnan(registered(u, 48)) ? 1 : 0;
  EXPECT_NEAR(num_holes, 3, 1) << "behind the right side of the square no depth was measured: 120 (0.05 - 0.025) px";
  EXPECT_TRUE(std::isnan(registered(127, 48))) << "beyond the field of view of the depth camera";
}

}  // namespace
}  // namespace resight
