// SPDX-License-Identifier: Apache-2.0
#include "resight/geometry/point_cloud.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <stdexcept>

#include "resight/core/random.hpp"

namespace resight {
namespace {

PointCloud random_cloud(int count, std::uint64_t seed) {
  Rng rng(seed);
  const auto component = [&] { return static_cast<float>(rng.uniform(-0.1, 0.1)); };
  const auto channel = [&] { return static_cast<std::uint8_t>(rng.below(256)); };
  PointCloud cloud;
  for (int i = 0; i < count; ++i) {
    cloud.points.emplace_back(component(), component(), component());
    cloud.normals.push_back(Eigen::Vector3f(component(), component(), component()).normalized());
    cloud.colors.push_back({channel(), channel(), channel()});
  }
  return cloud;
}

TEST(PointCloud, AppendKeepsAllAttributes) {
  const PointCloud a = random_cloud(3, 1);
  const PointCloud b = random_cloud(5, 2);
  PointCloud joined;
  joined.append(a);
  joined.append(b);
  joined.append(PointCloud());
  ASSERT_EQ(joined.size(), 8U);
  EXPECT_TRUE(joined.has_normals() && joined.has_colors());
  EXPECT_EQ(joined.points[2], a.points[2]);
  EXPECT_EQ(joined.points[3], b.points[0]);
  EXPECT_EQ(joined.normals[7], b.normals[4]);
  EXPECT_EQ(joined.colors[3], b.colors[0]);
}

TEST(PointCloud, AppendToItselfDoubles) {
  PointCloud cloud = random_cloud(100, 3);
  const PointCloud before = cloud;
  cloud.append(cloud);
  ASSERT_EQ(cloud.size(), 200U);
  EXPECT_TRUE(std::equal(before.points.begin(), before.points.end(), cloud.points.begin() + 100));
}

TEST(PointCloud, AppendRefusesOtherAttributes) {
  PointCloud with = random_cloud(2, 4);
  PointCloud without = with;
  without.normals.clear();
  EXPECT_THROW(with.append(without), std::invalid_argument);
  EXPECT_THROW(without.append(with), std::invalid_argument);
}

TEST(PointCloud, TransformMovesPointsAndOnlyRotatesNormals) {
  const PointCloud cloud = random_cloud(50, 5);
  Rigid3 motion = Rigid3::from_axis_angle({1, 2, 3}, 0.7);
  motion.translation = {1, 2, 3};
  const PointCloud moved = transform(motion, cloud);
  ASSERT_EQ(moved.size(), 50U);
  for (std::size_t i = 0; i < 50; ++i) {
    EXPECT_LT((moved.points[i].cast<double>() - motion * cloud.points[i].cast<double>()).norm(), 1e-6);
    EXPECT_LT((moved.normals[i].cast<double>() - motion.rotation * cloud.normals[i].cast<double>()).norm(), 1e-6);
    EXPECT_NEAR(moved.normals[i].norm(), 1, 1e-5);
  }
  EXPECT_EQ(moved.colors, cloud.colors);
  const PointCloud back = transform(motion.inverse(), moved);
  for (std::size_t i = 0; i < 50; ++i) EXPECT_LT((back.points[i] - cloud.points[i]).norm(), 1e-6F);
}

TEST(PointCloud, SelectTakesTheGivenOrder) {
  const PointCloud cloud = random_cloud(10, 6);
  const std::array<int, 4> indices{7, 0, 7, 3};
  const PointCloud chosen = select(cloud, indices);
  ASSERT_EQ(chosen.size(), 4U);
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_EQ(chosen.points[i], cloud.points[indices[i]]);
    EXPECT_EQ(chosen.normals[i], cloud.normals[indices[i]]);
    EXPECT_EQ(chosen.colors[i], cloud.colors[indices[i]]);
  }
  PointCloud bare;
  bare.points = cloud.points;
  EXPECT_FALSE(select(bare, indices).has_normals());
  EXPECT_TRUE(select(cloud, {}).empty());
}

TEST(VoxelDownsample, AgreesWithAMapOfCubes) {
  const PointCloud cloud = random_cloud(3000, 7);
  constexpr double kVoxel = 0.02;
  std::map<std::array<int, 3>, std::vector<int>> cubes;
  std::vector<std::array<int, 3>> order;
  for (int i = 0; i < 3000; ++i) {
    std::array<int, 3> cube{};
    for (int a = 0; a < 3; ++a) cube.at(a) = static_cast<int>(std::floor(cloud.points[i][a] * 50.0F));
    if (!cubes.contains(cube)) order.push_back(cube);
    cubes[cube].push_back(i);
  }
  const PointCloud thin = voxel_downsample(cloud, kVoxel);
  ASSERT_EQ(thin.size(), cubes.size());
  ASSERT_GT(thin.size(), 500U);
  ASSERT_LT(thin.size(), 1500U);
  EXPECT_FALSE(is_downsampled(cloud, kVoxel));
  EXPECT_TRUE(is_downsampled(thin, kVoxel));  // means stay in their cubes
  for (std::size_t k = 0; k < thin.size(); ++k) {
    Eigen::Vector3d mean = Eigen::Vector3d::Zero();
    Eigen::Vector3d normal = Eigen::Vector3d::Zero();
    Eigen::Vector3d color = Eigen::Vector3d::Zero();
    const std::vector<int>& members = cubes[order[k]];
    for (const int i : members) {
      mean += cloud.points[i].cast<double>();
      normal += cloud.normals[i].cast<double>();
      color += Eigen::Vector3d(cloud.colors[i].r, cloud.colors[i].g, cloud.colors[i].b);
    }
    mean /= static_cast<double>(members.size());
    color /= static_cast<double>(members.size());
    ASSERT_LT((thin.points[k].cast<double>() - mean).norm(), 1e-7);
    ASSERT_NEAR(thin.normals[k].norm(), 1, 1e-5);
    ASSERT_GT(thin.normals[k].cast<double>().dot(normal.normalized()), 0.999);
    ASSERT_NEAR(thin.colors[k].r, color.x(), 0.51);
    ASSERT_NEAR(thin.colors[k].b, color.z(), 0.51);
  }
}

TEST(VoxelDownsample, OppositeNormalsLeaveAUnitNormal) {
  PointCloud wall;
  wall.points = {{0.001F, 0, 0}, {0.002F, 0, 0}};
  wall.normals = {{0, 0, 1}, {0, 0, -1}};
  const PointCloud thin = voxel_downsample(wall, 0.01);
  ASSERT_EQ(thin.size(), 1U);
  EXPECT_EQ(thin.normals[0], Eigen::Vector3f(0, 0, 1));
}

TEST(VoxelDownsample, EdgeCases) {
  EXPECT_TRUE(voxel_downsample({}, 0.01).empty());
  EXPECT_THROW((void)voxel_downsample({}, 0), std::invalid_argument);
  PointCloud two;
  two.points = {{0.0005F, 0, 0}, {-0.0005F, 0, 0}};  // on both sides of the voxel border at zero
  EXPECT_EQ(voxel_downsample(two, 0.01).size(), 2U);
  EXPECT_FALSE(voxel_downsample(two, 0.01).has_normals());
}

TEST(Centroid, IsTheMeanAndZeroForNothing) {
  const std::array<Eigen::Vector3f, 2> points{Eigen::Vector3f(1, 2, 3), Eigen::Vector3f(3, 2, 1)};
  EXPECT_EQ(centroid(points), Eigen::Vector3f(2, 2, 2));
  EXPECT_EQ(centroid({}), Eigen::Vector3f(0, 0, 0));
  // A single-precision sum would stall here: 2^25 + 1 = 2^25.
  const std::vector<Eigen::Vector3f> many(3000000, Eigen::Vector3f(20.1F, 0, 0));
  EXPECT_NEAR(centroid(many).x(), 20.1F, 1e-5);
}

}  // namespace
}  // namespace resight
