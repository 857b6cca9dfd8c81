// SPDX-License-Identifier: Apache-2.0
#include "resight/geometry/view_frustum.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>

#include "resight/core/random.hpp"

namespace resight {
namespace {

constexpr double kRadPerDegree = std::numbers::pi / 180;

Camera off_center_camera() { return {640, 480, 500, 520, 200, 300}; }

/// Converts a pixel column (or row) to the angle of its ray.
double ray_angle(double pixel, double center_px, double focal_px) { return std::atan2(pixel - center_px, focal_px); }

/// The slow reference: projects, then compares the angles of the pixel and of the image borders.
bool contains_by_projection(const ViewFrustum& f, const Eigen::Vector3d& p) {
  if (!(p.z() > f.min_depth_m && p.z() < f.max_depth_m)) return false;
  const Camera& c = f.camera;
  const Eigen::Vector2d pixel = c.project(p);
  const double x = ray_angle(pixel.x(), c.cx, c.fx);
  const double y = ray_angle(pixel.y(), c.cy, c.fy);
  return x - ray_angle(-0.5, c.cx, c.fx) > f.margin_rad && ray_angle(c.width - 0.5, c.cx, c.fx) - x > f.margin_rad &&
         y - ray_angle(-0.5, c.cy, c.fy) > f.margin_rad && ray_angle(c.height - 0.5, c.cy, c.fy) - y > f.margin_rad;
}

TEST(ViewFrustum, AgreesWithProjection) {
  Rng rng(7);
  for (const Camera& camera : {make_kinect_camera(), off_center_camera()}) {
    for (const double margin : {0.0, 5 * kRadPerDegree, 15 * kRadPerDegree}) {
      const ViewFrustum frustum{.camera = camera, .margin_rad = margin};
      int num_inside = 0;
      for (int i = 0; i < 20000; ++i) {
        const Eigen::Vector3f p{static_cast<float>(rng.uniform(-4, 4)), static_cast<float>(rng.uniform(-4, 4)),
                                static_cast<float>(rng.uniform(-1, 5))};
        const bool inside = frustum.contains(p);
        EXPECT_EQ(inside, contains_by_projection(frustum, p.cast<double>())) << "point " << p.transpose();
        num_inside += inside ? 1 : 0;
      }
      EXPECT_GT(num_inside, 50) << "margin " << margin;
    }
  }
}

TEST(ViewFrustum, SidesFollowThePrincipalPoint) {
  const ViewFrustum frustum{.camera = off_center_camera(), .margin_rad = 0};
  EXPECT_TRUE(frustum.contains({0.8F, 0, 1}));    // column 600
  EXPECT_FALSE(frustum.contains({-0.8F, 0, 1}));  // column -200
  EXPECT_TRUE(frustum.contains({0, -0.5F, 1}));   // row 40
  EXPECT_FALSE(frustum.contains({0, 0.5F, 1}));   // row 560
}

TEST(ViewFrustum, FiveDegreesOffTheHalfAngle) {
  // The paper's code: |x| / sqrt(x^2 + z^2) < sin(58 deg / 2 - 5 deg) for the camera with 58 deg field of view.
  const double half = 29 * kRadPerDegree;
  const Camera camera{640, 480, 320 / std::tan(half), 320 / std::tan(half), 319.5, 239.5};
  const ViewFrustum frustum{.camera = camera};
  for (const double degrees : {-28.9, -24.1, -23.9, 0.0, 23.9, 24.1, 28.9}) {
    const Eigen::Vector3d p(std::sin(degrees * kRadPerDegree), 0, std::cos(degrees * kRadPerDegree));
    const bool expected = std::abs(p.x()) / std::hypot(p.x(), p.z()) < std::sin(half - 5 * kRadPerDegree);
    EXPECT_EQ(frustum.contains(p.cast<float>()), expected) << degrees;
  }
}

TEST(ViewFrustum, DepthRangeIsOpenAndNothingBehindTheCamera) {
  const ViewFrustum frustum{.camera = make_kinect_camera(), .min_depth_m = 0.5, .max_depth_m = 3.5};
  EXPECT_FALSE(frustum.contains({0, 0, 0.5F}));
  EXPECT_TRUE(frustum.contains({0, 0, 0.501F}));
  EXPECT_FALSE(frustum.contains({0, 0, 3.5F}));
  EXPECT_FALSE(frustum.contains({0, 0, -1}));
  const float nan = std::numeric_limits<float>::quiet_NaN();
  EXPECT_FALSE(frustum.contains({nan, 0, 1}));
  EXPECT_FALSE(frustum.contains({0, nan, 1}));
  EXPECT_FALSE(frustum.contains({0, 0, nan}));
}

TEST(ViewFrustum, MarginLargerThanTheViewLeavesNothing) {
  for (const double degrees : {30.0, 60.0, 89.0}) {
    const ViewFrustum frustum{.camera = make_kinect_camera(), .margin_rad = degrees * kRadPerDegree};
    EXPECT_FALSE(frustum.contains({0, 0, 1})) << degrees;
    EXPECT_FALSE(frustum.contains({0.5F, 0.3F, 1})) << degrees;
  }
}

TEST(ViewFrustum, RefusesNonsense) {
  EXPECT_THROW(ViewFrustum{}.check(), std::invalid_argument);
  const Camera camera = make_kinect_camera();
  EXPECT_NO_THROW((ViewFrustum{.camera = camera}.check()));
  EXPECT_THROW((ViewFrustum{.camera = camera, .min_depth_m = -1}.check()), std::invalid_argument);
  EXPECT_THROW((ViewFrustum{.camera = camera, .min_depth_m = 2, .max_depth_m = 2}.check()), std::invalid_argument);
  EXPECT_THROW((ViewFrustum{.camera = camera, .max_depth_m = std::nan("")}.check()), std::invalid_argument);
  EXPECT_THROW((ViewFrustum{.camera = camera, .margin_rad = -0.1}.check()), std::invalid_argument);
  EXPECT_THROW((void)(ViewFrustum{.camera = camera, .margin_rad = std::nan("")}.limits()), std::invalid_argument);
}

}  // namespace
}  // namespace resight
