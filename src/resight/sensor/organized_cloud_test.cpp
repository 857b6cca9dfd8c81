// SPDX-License-Identifier: Apache-2.0
#include "resight/sensor/organized_cloud.hpp"

#include <gtest/gtest.h>

#include <stdexcept>

#include "resight/sensor/sensor_test_scenes.hpp"

namespace resight {
namespace {

using test::kNan;
using test::small_camera;

TEST(BackProject, InvertsTheProjection) {
  const Camera camera = small_camera();
  const Image<float> depth = test::render_noisy_sphere(camera, 3);
  const OrganizedCloud cloud = back_project(camera, depth);
  int num_points = 0;
  for (int v = 0; v < camera.height; ++v)
    for (int u = 0; u < camera.width; ++u) {
      const std::size_t i = cloud.z.index(u, v);
      ASSERT_EQ(std::isnan(depth(u, v)), !cloud.has_point(i));
      ASSERT_EQ(std::isnan(cloud.x[i]), !cloud.has_point(i));
      ASSERT_EQ(std::isnan(cloud.y[i]), !cloud.has_point(i));
      ASSERT_FALSE(cloud.has_normal(i));
      if (!cloud.has_point(i)) continue;
      ++num_points;
      const Eigen::Vector2d pixel = camera.project(cloud.point(i).cast<double>());
      ASSERT_NEAR(pixel.x(), u, 1e-4);
      ASSERT_NEAR(pixel.y(), v, 1e-4);
      ASSERT_EQ(cloud.z[i], depth(u, v));
    }
  EXPECT_GT(num_points, 15000);
}

TEST(BackProject, RefusesBadInput) {
  EXPECT_THROW((void)back_project(small_camera(), Image<float>(10, 10, 1.0F)), std::invalid_argument);
  EXPECT_THROW((void)back_project(Camera{}, Image<float>()), std::invalid_argument);
}

class ToPointCloud : public testing::Test {
 protected:
  ToPointCloud()
      : cloud_(back_project(camera_, test::render_noisy_sphere(camera_, 3))), color_(camera_.width, camera_.height) {
    for (std::size_t i = 0; i < color_.size(); ++i)
      color_[i] = {static_cast<std::uint8_t>(i % 251), static_cast<std::uint8_t>(i / 251), 7};
  }
  Camera camera_ = small_camera();
  OrganizedCloud cloud_;
  Image<Rgb8> color_;
};

TEST_F(ToPointCloud, KeepsEveryMeasurementAndItsAttributes) {
  compute_normals(cloud_);
  for (const bool require_normal : {false, true}) {
    std::vector<int> pixels;
    const PointCloud points = to_point_cloud(cloud_, &color_, require_normal, &pixels);
    ASSERT_EQ(pixels.size(), points.size());
    ASSERT_TRUE(points.has_normals());
    ASSERT_TRUE(points.has_colors());
    std::size_t expected = 0;
    for (std::size_t i = 0; i < cloud_.z.size(); ++i)
      expected += cloud_.has_point(i) && (!require_normal || cloud_.has_normal(i)) ? 1 : 0;
    ASSERT_EQ(points.size(), expected);
    ASSERT_GT(expected, 15000U);
    for (std::size_t i = 0; i < points.size(); ++i) {
      ASSERT_EQ(points.points[i], cloud_.point(pixels[i]));
      ASSERT_EQ(points.colors[i], color_[pixels[i]]);
      if (require_normal) {
        ASSERT_EQ(points.normals[i], cloud_.normal(pixels[i]));
      }
      if (i > 0) {
        ASSERT_LT(pixels[i - 1], pixels[i]);
      }
    }
  }
}

TEST_F(ToPointCloud, GoesWithoutNormalsAndColors) {
  const PointCloud points = to_point_cloud(cloud_, nullptr, false);
  EXPECT_GT(points.size(), 15000U);
  EXPECT_FALSE(points.has_normals());
  EXPECT_FALSE(points.has_colors());
}

TEST_F(ToPointCloud, RefusesBadInput) {
  EXPECT_THROW((void)to_point_cloud(cloud_, nullptr, true), std::invalid_argument);  // normals have not been computed
  const Image<Rgb8> small(3, 3);
  EXPECT_THROW((void)to_point_cloud(cloud_, &small, false), std::invalid_argument);
}

}  // namespace
}  // namespace resight
