// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <numbers>
#include <stdexcept>
#include <vector>

#include "resight/sensor/organized_cloud.hpp"
#include "resight/sensor/sensor_test_scenes.hpp"

namespace resight {
namespace {

using test::kNan;
using test::small_camera;

double degrees(double rad) { return rad * 180 / std::numbers::pi; }
double angle_deg(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return degrees(std::atan2(a.cross(b).norm(), a.dot(b)));
}

struct OracleNormal {
  bool exists = false;
  double gap = 0;  ///< (l1 - l0) / trace: how well the direction is determined
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();
};

/// The definition in double precision with an eigenvalue solver.
OracleNormal normal_by_definition(const OrganizedCloud& cloud, int u, int v, const ComputeNormalsOptions& options) {
  const std::size_t center = cloud.z.index(u, v);
  if (!cloud.has_point(center)) return {};
  std::vector<Eigen::Vector3d> points{cloud.point(center).cast<double>()};
  const float z = cloud.z[center];
  for (int dv = -options.window_radius_px; dv <= options.window_radius_px; ++dv)
    for (int du = -options.window_radius_px; du <= options.window_radius_px; ++du) {
      if ((du == 0 && dv == 0) || !cloud.z.contains(u + du, v + dv)) continue;
      const std::size_t i = cloud.z.index(u + du, v + dv);
      if (std::abs(cloud.z[i] - z) < static_cast<float>(options.max_depth_change) * z)
        points.push_back(cloud.point(i).cast<double>());
    }
  if (static_cast<int>(points.size()) - 1 < options.min_neighbors) return {};
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const auto& p : points) mean += p / static_cast<double>(points.size());
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  for (const auto& p : points) covariance += (p - mean) * (p - mean).transpose();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(covariance);
  OracleNormal result{true, (solver.eigenvalues()[1] - solver.eigenvalues()[0]) / covariance.trace(),
                      solver.eigenvectors().col(0)};
  if (result.normal.dot(points[0]) > 0) result.normal *= -1;
  return result;
}

TEST(ComputeNormals, GivesTheNormalOfAPlaneEverywhereFacingTheCamera) {
  const Camera camera = small_camera();
  for (const Eigen::Vector3d& direction :
       {Eigen::Vector3d(0, 0, 1), Eigen::Vector3d(0.6, -0.3, 1), Eigen::Vector3d(-1.2, 0.9, 1)}) {
    const Eigen::Vector3d normal = direction.normalized();
    OrganizedCloud cloud = back_project(camera, test::render_plane(camera, normal, 0.9));
    compute_normals(cloud);
    int num_checked = 0;
    for (std::size_t i = 0; i < cloud.z.size(); ++i) {
      if (!cloud.has_normal(i)) continue;
      ++num_checked;
      ASSERT_NEAR(cloud.normal(i).norm(), 1.0F, 1e-5F);
      ASSERT_LT(cloud.normal(i).dot(cloud.point(i)), 0);
      ASSERT_LT(angle_deg(cloud.normal(i).cast<double>(), -normal), 0.1) << "pixel " << i;
    }
    EXPECT_GT(num_checked, 15000) << direction.transpose();
  }
}

TEST(ComputeNormals, FollowsASphere) {
  const Camera camera = small_camera();
  const Eigen::Vector3d center(0.05, 0.02, 1.0);
  OrganizedCloud cloud = back_project(camera, test::render_sphere(camera, center, 0.25, 3.0));
  compute_normals(cloud);
  int num_checked = 0;
  for (std::size_t i = 0; i < cloud.z.size(); ++i) {
    const Eigen::Vector3d truth = (cloud.point(i).cast<double>() - center).normalized();
    if (!cloud.has_normal(i) || cloud.z[i] > 2 || truth.dot(-cloud.point(i).cast<double>().normalized()) < 0.5)
      continue;
    ++num_checked;
    ASSERT_LT(angle_deg(cloud.normal(i).cast<double>(), truth), 1.5);
  }
  EXPECT_GT(num_checked, 2000);
}

struct Deviation {
  int num_checked = 0;
  int num_without = 0;
  double mean_deg = 0;
  double worst_deg = 0;
};

/// Deviation of compute_normals() from the definition over windows with a clear direction. Both must omit the same
/// pixels.
Deviation compare_with_definition(OrganizedCloud cloud, const ComputeNormalsOptions& options) {
  compute_normals(cloud, options);
  Deviation result;
  for (int v = 0; v < cloud.height(); ++v)
    for (int u = 0; u < cloud.width(); ++u) {
      const OracleNormal oracle = normal_by_definition(cloud, u, v, options);
      const std::size_t i = cloud.z.index(u, v);
      if (!oracle.exists) {
        EXPECT_FALSE(cloud.has_normal(i)) << u << ", " << v;
        ++result.num_without;
        continue;
      }
      if (oracle.gap < 0.05) continue;
      EXPECT_TRUE(cloud.has_normal(i)) << u << ", " << v;
      const Eigen::Vector3d found = cloud.normal(i).cast<double>();
      double error_deg = angle_deg(found, oracle.normal);
      // The sign of a normal perpendicular to the ray is undefined.
      if (std::abs(found.dot(cloud.point(i).cast<double>().normalized())) < 1e-3)
        error_deg = std::min(error_deg, 180 - error_deg);
      result.mean_deg += error_deg;
      result.worst_deg = std::max(result.worst_deg, error_deg);
      ++result.num_checked;
    }
  result.mean_deg /= result.num_checked;
  return result;
}

TEST(ComputeNormals, AgreesWithTheDefinitionInDoublePrecision) {
  const Camera camera = small_camera();
  for (const double noise_share : {0.001, 0.006})
    for (const auto& options :
         {ComputeNormalsOptions{}, ComputeNormalsOptions{.window_radius_px = 4, .min_neighbors = 20}}) {
      const OrganizedCloud cloud = back_project(camera, test::render_noisy_sphere(camera, 5, noise_share));
      const Deviation deviation = compare_with_definition(cloud, options);
      EXPECT_GT(deviation.num_checked, 10000);
      EXPECT_GT(deviation.num_without, 300);
      EXPECT_LT(deviation.mean_deg, 1e-5);
      EXPECT_LT(deviation.worst_deg, 1e-3);
    }
}

TEST(ComputeNormals, KeepsApartWhatLiesAtDifferentDepths) {
  const Camera camera = small_camera();
  Image<float> depth(camera.width, camera.height, 1.0F);
  for (int v = 0; v < camera.height; ++v)
    for (int u = 70; u < camera.width; ++u) depth(u, v) = 1.3F;
  OrganizedCloud cloud = back_project(camera, depth);
  compute_normals(cloud);
  for (std::size_t i = 0; i < cloud.z.size(); ++i) {
    ASSERT_TRUE(cloud.has_normal(i));
    ASSERT_LT(angle_deg(cloud.normal(i).cast<double>(), -Eigen::Vector3d::UnitZ()), 0.05);
  }
}

TEST(ComputeNormals, HasNoneWithoutEnoughNeighbors) {
  Camera camera = small_camera();
  Image<float> depth(camera.width, camera.height, kNan);
  depth(40, 40) = 1.0F;                               // isolated
  for (int u = 60; u < 90; ++u) depth(u, 80) = 1.0F;  // a line, which does not span a plane
  for (int v = 10; v < 30; ++v)
    for (int u = 10; u < 30; ++u) depth(u, v) = 1.0F;  // a patch
  OrganizedCloud cloud = back_project(camera, depth);
  compute_normals(cloud, {.min_neighbors = 4});
  EXPECT_FALSE(cloud.has_normal(cloud.z.index(40, 40)));
  for (int u = 60; u < 90; ++u) EXPECT_FALSE(cloud.has_normal(cloud.z.index(u, 80))) << u;
  for (int v = 10; v < 30; ++v)
    for (int u = 10; u < 30; ++u) EXPECT_TRUE(cloud.has_normal(cloud.z.index(u, v)));
  EXPECT_FALSE(cloud.has_normal(cloud.z.index(30, 30)));  // beside the patch, but not a point
}

TEST(ComputeNormals, IsTheSameForAnyNumberOfThreads) {
  const Camera camera = small_camera();
  OrganizedCloud serial = back_project(camera, test::render_noisy_sphere(camera, 7));
  OrganizedCloud parallel = serial;
  compute_normals(serial, {.num_threads = 1});
  compute_normals(parallel, {.num_threads = 3});
  EXPECT_TRUE(test::same_bytes(serial.nx, parallel.nx));
  EXPECT_TRUE(test::same_bytes(serial.ny, parallel.ny));
  EXPECT_TRUE(test::same_bytes(serial.nz, parallel.nz));
}

TEST(ComputeNormals, WorksOnImagesSmallerThanTheWindow) {
  const Camera camera{3, 2, 100, 100, 1, 0.5};
  OrganizedCloud cloud = back_project(camera, Image<float>(3, 2, 1.0F));
  compute_normals(cloud, {.window_radius_px = 5, .min_neighbors = 5});
  for (std::size_t i = 0; i < 6; ++i) EXPECT_NEAR(cloud.nz[i], -1.0F, 1e-5F);
  OrganizedCloud empty;
  compute_normals(empty);
  EXPECT_TRUE(empty.nx.empty());
}

TEST(ComputeNormals, RefusesBadOptions) {
  OrganizedCloud cloud = back_project(small_camera(), Image<float>(150, 110, 1.0F));
  EXPECT_THROW(compute_normals(cloud, {.window_radius_px = 0}), std::invalid_argument);
  EXPECT_THROW(compute_normals(cloud, {.max_depth_change = -0.1}), std::invalid_argument);
  EXPECT_THROW(compute_normals(cloud, {.max_depth_change = kNan}), std::invalid_argument);
  EXPECT_THROW(compute_normals(cloud, {.min_neighbors = 1}), std::invalid_argument);
  EXPECT_THROW(compute_normals(cloud, {.num_threads = 0}), std::invalid_argument);
}

}  // namespace
}  // namespace resight
