// SPDX-License-Identifier: Apache-2.0
#include "resight/geometry/camera.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <optional>

#include "resight/core/random.hpp"

namespace resight {
namespace {

TEST(Camera, ProjectAndUnprojectAreInverse) {
  const Camera camera{640, 480, 500, 510, 321, 237};
  Rng rng(1);
  for (int i = 0; i < 500; ++i) {
    const double u = rng.uniform(-10, 650);
    const double v = rng.uniform(-10, 490);
    const double z = rng.uniform(0.3, 5);
    const Eigen::Vector3d p = camera.unproject(u, v, z);
    ASSERT_EQ(p.z(), z);
    ASSERT_LT((camera.project(p) - Eigen::Vector2d(u, v)).norm(), 1e-9);
    ASSERT_LT((camera.project(2.5 * p) - Eigen::Vector2d(u, v)).norm(), 1e-9);  // along the ray
  }
}

TEST(Camera, HandComputedPixel) {
  const Camera camera = make_kinect_camera();
  const Eigen::Vector2d pixel = camera.project({0.1, -0.2, 1.0});
  EXPECT_NEAR(pixel.x(), 319.5 + 52.5, 1e-9);
  EXPECT_NEAR(pixel.y(), 239.5 - 105.0, 1e-9);
}

TEST(Camera, PixelOfIsTheNearestCentreWithinTheImage) {
  const Camera camera{320, 240, 250, 260, 161, 118};
  Rng rng(2);
  int num_inside = 0;
  for (int i = 0; i < 2000; ++i) {
    const Eigen::Vector3d p{rng.uniform(-2, 2), rng.uniform(-2, 2), rng.uniform(-1, 3)};
    const std::optional<Pixel> pixel = camera.pixel_of(p);
    const bool is_seen = p.z() > 0 && camera.contains(camera.project(p));
    ASSERT_EQ(pixel.has_value(), is_seen);
    if (!is_seen) continue;
    ++num_inside;
    EXPECT_LE(std::abs(pixel->u - camera.project(p).x()), 0.5);
    EXPECT_LE(std::abs(pixel->v - camera.project(p).y()), 0.5);
    EXPECT_TRUE(pixel->u >= 0 && pixel->u < camera.width && pixel->v >= 0 && pixel->v < camera.height);
  }
  EXPECT_GT(num_inside, 200);
}

TEST(Camera, PixelAtTheBorders) {
  const Camera camera{4, 1, 10, 10, 0, 0};
  EXPECT_EQ(camera.pixel_at({-0.5, -0.5}), (Pixel{0, 0}));  // Rounding away from zero would leave the image.
  EXPECT_EQ(camera.pixel_at({1.5, 0}), (Pixel{2, 0}));
  EXPECT_EQ(camera.pixel_at({3, std::nextafter(0.5, 0)}), (Pixel{3, 0}));  // 0.5 and this is 1.
  EXPECT_FALSE(camera.pixel_at({3.5, 0}));
  constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(camera.pixel_at({kNaN, 0}));
  EXPECT_FALSE(camera.pixel_at({0, kNaN}));
  EXPECT_FALSE(camera.pixel_of({0, 0, 0}));
  EXPECT_FALSE(camera.pixel_of({0, 0, -1}));
  EXPECT_FALSE(camera.pixel_of({0, 0, kNaN}));
}

TEST(Camera, ContainsHalfAPixelAroundTheCentres) {
  const Camera camera = make_kinect_camera();
  EXPECT_TRUE(camera.contains({-0.5, -0.5}));
  EXPECT_FALSE(camera.contains({-0.51, 0}));
  EXPECT_FALSE(camera.contains({0, -0.51}));
  EXPECT_TRUE(camera.contains({639.49, 479.49}));
  EXPECT_FALSE(camera.contains({639.5, 0}));
  EXPECT_FALSE(camera.contains({0, 479.5}));
  EXPECT_FALSE(camera.contains({std::numeric_limits<double>::quiet_NaN(), 0}));
}

TEST(Camera, Validity) {
  EXPECT_TRUE(make_kinect_camera().is_valid());
  EXPECT_FALSE(Camera{}.is_valid());
  Camera bad = make_kinect_camera();
  bad.fx = -525;
  EXPECT_FALSE(bad.is_valid());
  bad = make_kinect_camera();
  bad.cy = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(bad.is_valid());
  bad = make_kinect_camera();
  bad.height = 0;
  EXPECT_FALSE(bad.is_valid());
}

}  // namespace
}  // namespace resight
