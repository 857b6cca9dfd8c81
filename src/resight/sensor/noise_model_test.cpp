// SPDX-License-Identifier: Apache-2.0
#include "resight/sensor/noise_model.hpp"

#include <gtest/gtest.h>

#include <numbers>
#include <stdexcept>

#include "resight/sensor/sensor_test_scenes.hpp"

namespace resight {
namespace {

using test::kNan;
using test::small_camera;
constexpr double kDegree = std::numbers::pi / 180;

TEST(NguyenNoise, MatchesValuesWorkedByHand) {
  // Frontal at 0.4 m: 0.8 px * 0.4 / 525; all other terms vanish.
  EXPECT_NEAR(nguyen_noise(0.4, 0, 525).lateral_m, 6.0952381e-4, 1e-11);
  EXPECT_NEAR(nguyen_noise(0.4, 0, 525).axial_m, 0.0012, 1e-12);
  // 1.4 m at 45 deg: the ratio theta / (90 deg - theta) is 1. 0.835 * 1.4 / 525; 0.0012 + 0.0019 + 0.0001 / 1.18321596.
  EXPECT_NEAR(nguyen_noise(1.4, 45 * kDegree, 525).lateral_m, 2.2266667e-3, 1e-10);
  EXPECT_NEAR(nguyen_noise(1.4, 45 * kDegree, 525).axial_m, 3.1845154e-3, 1e-10);
  // 1 m at 60 deg: the ratio is 2. 0.87 / 500; 0.0012 + 0.0019 * 0.36 + 0.0001 * 4.
  EXPECT_NEAR(nguyen_noise(1.0, 60 * kDegree, 500).lateral_m, 1.74e-3, 1e-10);
  EXPECT_NEAR(nguyen_noise(1.0, 60 * kDegree, 500).axial_m, 2.284e-3, 1e-10);
}

TEST(NguyenNoise, IsClippedAt85Degrees) {
  const NoiseSigma limit = nguyen_noise(1.0, 85 * kDegree, 525);
  EXPECT_NEAR(limit.axial_m, 0.0012 + 0.0019 * 0.36 + 0.0001 * 17 * 17, 1e-9);
  for (const double angle_deg : {86.0, 90.0, 120.0}) {
    EXPECT_DOUBLE_EQ(nguyen_noise(1.0, angle_deg * kDegree, 525).axial_m, limit.axial_m);
    EXPECT_DOUBLE_EQ(nguyen_noise(1.0, angle_deg * kDegree, 525).lateral_m, limit.lateral_m);
  }
}

TEST(NguyenNoise, GrowsWithDepthAndAngle) {
  for (double z = 0.5; z < 5; z += 0.25)
    for (double angle = 0; angle < 85 * kDegree; angle += 5 * kDegree) {
      const NoiseSigma here = nguyen_noise(z, angle, 525);
      const NoiseSigma steeper = nguyen_noise(z, angle + kDegree, 525);
      EXPECT_GT(steeper.lateral_m, here.lateral_m);
      EXPECT_GT(steeper.axial_m, here.axial_m);
      EXPECT_GT(nguyen_noise(z + 0.1, angle, 525).lateral_m, here.lateral_m);
      // At grazing angles, the axial term with 1/sqrt(z) decreases with depth. The rule holds where this term is small.
      if (angle < 45 * kDegree) {
        EXPECT_GT(nguyen_noise(z + 0.1, angle, 525).axial_m, here.axial_m);
      }
    }
}

TEST(NguyenNoise, RefusesBadInput) {
  EXPECT_THROW((void)nguyen_noise(0, 0, 525), std::invalid_argument);
  EXPECT_THROW((void)nguyen_noise(kNan, 0, 525), std::invalid_argument);
  EXPECT_THROW((void)nguyen_noise(1, -0.1, 525), std::invalid_argument);
  EXPECT_THROW((void)nguyen_noise(1, kNan, 525), std::invalid_argument);
  EXPECT_THROW((void)nguyen_noise(1, 0, 0), std::invalid_argument);
}

TEST(ModelNoise, IsNguyenNoiseOfEachPixelByTheAngleToItsRay) {
  const Camera camera = small_camera();
  OrganizedCloud cloud = back_project(camera, test::render_noisy_sphere(camera, 2));
  compute_normals(cloud);
  const NoiseImages noise = model_noise(cloud, camera);
  int num_with_normal = 0;
  int num_without_normal = 0;
  int num_missing = 0;
  for (std::size_t i = 0; i < cloud.z.size(); ++i) {
    if (!cloud.has_point(i)) {
      ASSERT_TRUE(std::isnan(noise.lateral_m[i]) && std::isnan(noise.axial_m[i]));
      ++num_missing;
      continue;
    }
    double angle = 85 * kDegree;
    if (cloud.has_normal(i)) {
      const Eigen::Vector3d ray = cloud.point(i).cast<double>().normalized();
      angle = std::acos(std::min(1.0, -ray.dot(cloud.normal(i).cast<double>())));
    }
    (cloud.has_normal(i) ? num_with_normal : num_without_normal) += 1;
    const NoiseSigma expected = nguyen_noise(cloud.z[i], angle, (camera.fx + camera.fy) / 2);
    // Near the clipping angle, the ratio changes quickly with the angle.
    const double tolerance = angle > 80 * kDegree ? 1e-3 : 1e-4;
    ASSERT_NEAR(noise.lateral_m[i] / expected.lateral_m, 1, tolerance);
    ASSERT_NEAR(noise.axial_m[i] / expected.axial_m, 1, tolerance) << angle / kDegree;
  }
  EXPECT_GT(num_with_normal, 15000);
  EXPECT_GT(num_without_normal, 5);
  EXPECT_GT(num_missing, 300);
}

TEST(ModelNoise, HoldsTheWorstForACloudWithoutNormals) {
  const Camera camera = small_camera();
  const OrganizedCloud cloud = back_project(camera, Image<float>(camera.width, camera.height, 1.0F));
  const NoiseImages noise = model_noise(cloud, camera);
  const NoiseSigma worst = nguyen_noise(1.0, 85 * kDegree, (camera.fx + camera.fy) / 2);
  for (std::size_t i = 0; i < cloud.z.size(); ++i) {
    ASSERT_NEAR(noise.lateral_m[i], worst.lateral_m, 1e-6);
    ASSERT_NEAR(noise.axial_m[i], worst.axial_m, 1e-6);
  }
}

TEST(ModelNoise, IsTheSameForAnyNumberOfThreads) {
  const Camera camera = small_camera();
  OrganizedCloud cloud = back_project(camera, test::render_noisy_sphere(camera, 2));
  compute_normals(cloud);
  const NoiseImages serial = model_noise(cloud, camera, 1);
  const NoiseImages parallel = model_noise(cloud, camera, 3);
  EXPECT_TRUE(test::same_bytes(serial.lateral_m, parallel.lateral_m));
  EXPECT_TRUE(test::same_bytes(serial.axial_m, parallel.axial_m));
}

TEST(ModelNoise, RefusesACloudOfAnotherSize) {
  const Camera camera = small_camera();
  const OrganizedCloud cloud = back_project(camera, Image<float>(camera.width, camera.height, 1.0F));
  EXPECT_THROW((void)model_noise(cloud, make_kinect_camera()), std::invalid_argument);
  EXPECT_THROW((void)model_noise(cloud, camera, 0), std::invalid_argument);
}

}  // namespace
}  // namespace resight
