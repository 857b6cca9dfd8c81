// SPDX-License-Identifier: Apache-2.0
#include "resight/geometry/camera.hpp"

#include <gtest/gtest.h>

#include <limits>

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
