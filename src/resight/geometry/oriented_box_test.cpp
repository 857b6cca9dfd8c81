// SPDX-License-Identifier: Apache-2.0
#include "resight/geometry/oriented_box.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

#include "resight/core/random.hpp"

namespace resight {
namespace {

PointCloud random_box(const Rigid3& world_from_box, const Eigen::Vector3d& size_m, int num_points, std::uint64_t seed) {
  Rng rng(seed);
  PointCloud cloud;
  for (int i = 0; i < num_points; ++i) {
    const Eigen::Vector3d p(rng.uniform(-0.5, 0.5), rng.uniform(-0.5, 0.5), rng.uniform(-0.5, 0.5));
    cloud.points.push_back((world_from_box * p.cwiseProduct(size_m).eval()).cast<float>());
  }
  return cloud;
}

TEST(FitBox, FindsPoseAndSizeOfABox) {
  const Rigid3 world_from_box{Rigid3::from_axis_angle({1, -2, 0.5}, 0.8).rotation, {0.3, -1, 2}};
  const OrientedBox box = fit_box(random_box(world_from_box, {0.1, 0.3, 0.2}, 20000, 1));
  EXPECT_NEAR(box.size_m.x(), 0.3, 0.01);
  EXPECT_NEAR(box.size_m.y(), 0.2, 0.01);
  EXPECT_NEAR(box.size_m.z(), 0.1, 0.01);
  EXPECT_LT((box.world_from_box.translation - world_from_box.translation).norm(), 0.005);
  EXPECT_GT(std::abs(box.world_from_box.rotation.col(0).dot(world_from_box.rotation.col(1))), 0.999);
  EXPECT_GT(std::abs(box.world_from_box.rotation.col(2).dot(world_from_box.rotation.col(0))), 0.999);
  EXPECT_TRUE(box.world_from_box.is_rigid());
}

TEST(FitBox, HoldsAllPoints) {
  const PointCloud cloud = random_box({}, {0.1, 0.3, 0.2}, 50, 2);
  const OrientedBox box = fit_box(cloud);
  const Rigid3 box_from_world = box.world_from_box.inverse();
  for (const Eigen::Vector3f& p : cloud.points) {
    const Eigen::Vector3d in_box = (box_from_world * p.cast<double>().eval()).cwiseAbs();
    EXPECT_TRUE((in_box.array() <= box.size_m.array() / 2 + 1e-6).all());
  }
}

TEST(FitBox, StrayPointsDoNotCount) {
  const Rigid3 world_from_box{Rigid3::from_axis_angle({1, -2, 0.5}, 0.8).rotation, {0.3, -1, 2}};
  PointCloud cloud = random_box(world_from_box, {0.06, 0.22, 0.1}, 3000, 3);
  const OrientedBox clean = fit_box(cloud);
  for (int i = 0; i < 40; ++i)  // A trail behind the edge of the object.
    cloud.points.emplace_back((world_from_box * Eigen::Vector3d(0.05 + 0.005 * i, 0.08, 0.04)).cast<float>());
  const OrientedBox box = fit_box(cloud);
  EXPECT_LT((box.size_m - clean.size_m).cwiseAbs().maxCoeff(), 0.015);
  EXPECT_LT((box.world_from_box.translation - clean.world_from_box.translation).norm(), 0.01);
  EXPECT_GT(std::abs(box.world_from_box.rotation.col(0).dot(clean.world_from_box.rotation.col(0))), 0.98);
}

TEST(FitBox, APointIsABoxWithoutSize) {
  const OrientedBox box = fit_box({{{1, 2, 3}}, {}, {}});
  EXPECT_EQ(box.size_m, Eigen::Vector3d::Zero());
  EXPECT_EQ(box.world_from_box.translation, Eigen::Vector3d(1, 2, 3));
}

TEST(FitBox, RefusesAnEmptyCloud) { EXPECT_THROW((void)fit_box({}), std::invalid_argument); }

}  // namespace
}  // namespace resight
