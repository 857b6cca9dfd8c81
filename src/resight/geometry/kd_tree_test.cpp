// SPDX-License-Identifier: Apache-2.0
#include "resight/geometry/kd_tree.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "resight/core/random.hpp"

namespace resight {
namespace {

std::vector<Eigen::Vector3f> random_points(int count, Rng& rng) {
  std::vector<Eigen::Vector3f> points;
  for (int i = 0; i < count; ++i)
    points.push_back(
        {static_cast<float>(rng.uniform()), static_cast<float>(rng.uniform()), static_cast<float>(rng.uniform())});
  return points;
}

std::vector<float> sorted_distances_sq(const std::vector<Eigen::Vector3f>& points, const Eigen::Vector3f& query) {
  std::vector<float> distances;
  for (const auto& p : points) distances.push_back((p - query).squaredNorm());
  std::ranges::sort(distances);
  return distances;
}

// Compares distances, not indices: the order of equally distant points is arbitrary.
TEST(KdTree, AgreesWithBruteForce) {
  Rng rng(1);
  for (const int count : {1, 2, 9, 11, 500}) {
    const std::vector<Eigen::Vector3f> points = random_points(count, rng);
    const KdTree tree(points);
    for (const Eigen::Vector3f& query : random_points(50, rng)) {
      const std::vector<float> expected = sorted_distances_sq(points, query);
      const PointNeighbor nearest = tree.nearest(query);
      ASSERT_NEAR(nearest.distance_sq, expected[0], 1e-6);
      ASSERT_NEAR((points[nearest.index] - query).squaredNorm(), expected[0], 1e-6);
      const std::vector<PointNeighbor> five = tree.nearest(query, 5);
      ASSERT_EQ(five.size(), std::min<std::size_t>(5, points.size()));
      for (std::size_t i = 0; i < five.size(); ++i) {
        ASSERT_NEAR(five[i].distance_sq, expected[i], 1e-6);
        ASSERT_NEAR((points[five[i].index] - query).squaredNorm(), five[i].distance_sq, 1e-6);
      }
    }
  }
}

TEST(KdTree, WithinAgreesWithBruteForceInOrderOfIndex) {
  Rng rng(2);
  const std::vector<Eigen::Vector3f> points = random_points(800, rng);
  const KdTree tree(points);
  std::vector<PointNeighbor> found{{42, 1.0F}};  // must be overwritten
  std::size_t total = 0;
  for (const Eigen::Vector3f& query : random_points(50, rng)) {
    std::vector<int> expected;
    for (int i = 0; i < 800; ++i)
      if ((points[i] - query).norm() < 0.2F) expected.push_back(i);
    tree.within(query, 0.2, found);
    std::vector<int> indices;
    for (const PointNeighbor& n : found) indices.push_back(n.index);
    ASSERT_EQ(indices, expected);
    total += expected.size();
  }
  EXPECT_GT(total, 500U);
}

TEST(KdTree, FindsAllOfManyEqualPoints) {
  const std::vector<Eigen::Vector3f> points(100, Eigen::Vector3f(1, 1, 1));
  const KdTree tree(points);
  std::vector<PointNeighbor> found;
  tree.within({1, 1, 1}, 0.01, found);
  EXPECT_EQ(found.size(), 100U);
  EXPECT_EQ(tree.nearest({1, 1, 1}, 7).size(), 7U);
  EXPECT_EQ(tree.nearest({1, 1, 3}).distance_sq, 4.0F);
}

TEST(KdTree, NothingIsNearInAnEmptyCloudOrToNan) {
  const KdTree empty({});
  std::vector<PointNeighbor> found{{1, 1.0F}};
  EXPECT_EQ(empty.nearest({0, 0, 0}).index, -1);
  EXPECT_TRUE(empty.nearest({0, 0, 0}, 3).empty());
  empty.within({0, 0, 0}, 1, found);
  EXPECT_TRUE(found.empty());

  Rng rng(3);
  const KdTree tree(random_points(50, rng));
  const Eigen::Vector3f nan = Eigen::Vector3f::Constant(std::numeric_limits<float>::quiet_NaN());
  EXPECT_EQ(tree.nearest(nan).index, -1);
  EXPECT_TRUE(tree.nearest(nan, 3).empty());
  EXPECT_TRUE(tree.nearest({0, 0, 0}, 0).empty());
  EXPECT_TRUE(tree.nearest({0, 0, 0}, -1).empty());
}

TEST(KdTree, KeepsItsPointsWhenMoved) {
  Rng rng(4);
  std::vector<Eigen::Vector3f> points = random_points(100, rng);
  KdTree tree(points);
  const Eigen::Vector3f last = points.back();
  points.assign(points.size(), Eigen::Vector3f(9, 9, 9));
  KdTree moved = std::move(tree);
  EXPECT_EQ(moved.nearest(last).index, 99);
  EXPECT_EQ(moved.nearest(last).distance_sq, 0.0F);
}

}  // namespace
}  // namespace resight
