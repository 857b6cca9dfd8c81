// SPDX-License-Identifier: Apache-2.0
#include "resight/changes/removal_support.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <stdexcept>

#include "resight/core/random.hpp"

namespace resight {
namespace {

using Points = std::vector<Eigen::Vector3f>;

/// The slow reference: flood over all pairs.
std::vector<std::vector<int>> cluster_slowly(const Points& points, double distance_m, int min_points) {
  const auto distance = static_cast<float>(distance_m);
  std::vector<int> label(points.size(), -1);
  std::vector<std::vector<int>> clusters;
  for (std::size_t seed = 0; seed < points.size(); ++seed) {
    if (label[seed] >= 0 || !points[seed].allFinite()) continue;
    std::vector<int> members{static_cast<int>(seed)};
    label[seed] = static_cast<int>(seed);
    for (std::size_t next = 0; next < members.size(); ++next)
      for (std::size_t i = 0; i < points.size(); ++i) {
        if (label[i] >= 0 || !((points[i] - points[members[next]]).squaredNorm() <= distance * distance)) continue;
        label[i] = static_cast<int>(seed);
        members.push_back(static_cast<int>(i));
      }
    std::sort(members.begin(), members.end());
    if (static_cast<int>(members.size()) >= min_points) clusters.push_back(members);
  }
  return clusters;
}

TEST(ClusterPoints, AgreesWithFlooding) {
  Rng rng(8);
  Points points;
  for (int i = 0; i < 1200; ++i)
    points.push_back({static_cast<float>(rng.uniform(-0.3, 0.3)), static_cast<float>(rng.uniform(-0.3, 0.3)),
                      static_cast<float>(rng.uniform(-0.05, 0.05))});
  points[3] = Eigen::Vector3f::Constant(std::numeric_limits<float>::quiet_NaN());
  for (const double distance : {0.005, 0.015, 0.02, 0.03, 0.2}) {
    for (const int min_points : {1, 3, 40}) {
      const auto expected = cluster_slowly(points, distance, min_points);
      EXPECT_EQ(cluster_points(points, distance, min_points), expected) << distance << " " << min_points;
      if (distance == 0.015 && min_points == 3) {
        EXPECT_GT(expected.size(), 5U);
      }
    }
  }
}

TEST(ClusterPoints, ChainAtExactlyTheDistance) {
  Points chain;
  for (int i = -5; i < 5; ++i) chain.emplace_back(0.25F * static_cast<float>(i), 0, 0);
  EXPECT_EQ(cluster_points(chain, 0.25, 1).size(), 1U);
  EXPECT_EQ(cluster_points(chain, 0.2499, 1).size(), chain.size());
  EXPECT_TRUE(cluster_points(Points{}, 0.1, 1).empty());
  EXPECT_THROW((void)cluster_points(chain, 0, 1), std::invalid_argument);
}

/// A square sheet of 11 x 11 points, 5 mm apart.
PointCloud sheet(const Eigen::Vector3f& corner) {
  PointCloud cloud;
  for (int i = 0; i <= 10; ++i)
    for (int j = 0; j <= 10; ++j)
      cloud.points.push_back(corner + 0.005F * Eigen::Vector3f(static_cast<float>(i), static_cast<float>(j), 0));
  return cloud;
}

TEST(CountRemovalSupport, CountsTheClustersOnTheSurface) {
  const PointCloud surface = sheet({0, 0, 0});
  PointCloud removed = sheet({0, 0, 0.01F});
  EXPECT_EQ(count_removal_support(surface, removed), 121);
  removed.append(sheet({0.5F, 0, 0}));  // a second cluster, elsewhere
  EXPECT_EQ(count_removal_support(surface, removed), 121);
  removed.append(sheet({0, 0, -0.015F}));  // joins the first one
  EXPECT_EQ(count_removal_support(surface, removed), 242);
}

TEST(CountRemovalSupport, ALargerChangeDoesNotSpeakForTheObject) {
  // A removed board three times as long as the object: two thirds of the cluster lie off its surface.
  const PointCloud surface = sheet({0, 0, 0});
  PointCloud removed = sheet({0, 0, 0});
  removed.append(sheet({0.055F, 0, 0}));
  removed.append(sheet({0.11F, 0, 0}));
  EXPECT_EQ(count_removal_support(surface, removed), 0);
  EXPECT_EQ(count_removal_support(surface, removed, {.min_overlap = 0.3}), 363);
}

TEST(CountRemovalSupport, SmallClustersAndEmptyClouds) {
  const PointCloud surface = sheet({0, 0, 0});
  PointCloud specks;
  for (int i = 0; i < 49; ++i) specks.points.push_back(surface.points[static_cast<std::size_t>(i)]);
  EXPECT_EQ(count_removal_support(surface, specks), 0);
  specks.points.push_back(surface.points[49]);
  EXPECT_EQ(count_removal_support(surface, specks), 50);
  EXPECT_EQ(count_removal_support(surface, {}), 0);
  EXPECT_EQ(count_removal_support({}, specks), 0);
}

TEST(CountRemovalSupport, ClustersThatStandGiveTheSame) {
  const PointCloud surface = sheet({0, 0, 0});
  PointCloud removed = sheet({0, 0.02F, 0.01F});
  removed.append(sheet({0.5F, 0, 0}));
  const RemovalSupportOptions options{.min_overlap = 0.5};
  const auto clusters = cluster_points(removed.points, options.cluster_distance_m, options.min_cluster_points);
  ASSERT_EQ(clusters.size(), 2U);
  EXPECT_GT(count_removal_support(surface, removed, options), 0);
  EXPECT_EQ(count_removal_support(ProximityGrid(surface.points, options.model_distance_m), Rigid3::identity(), removed,
                                  clusters, options),
            count_removal_support(surface, removed, options));
}

TEST(CountRemovalSupport, RefusesNonsense) {
  const PointCloud cloud = sheet({0, 0, 0});
  EXPECT_THROW((void)count_removal_support(cloud, cloud, {.cluster_distance_m = 0}), std::invalid_argument);
  EXPECT_THROW((void)count_removal_support(cloud, cloud, {.min_cluster_points = 0}), std::invalid_argument);
  EXPECT_THROW((void)count_removal_support(cloud, cloud, {.model_distance_m = -1}), std::invalid_argument);
  EXPECT_THROW((void)count_removal_support(cloud, cloud, {.min_overlap = 1.1}), std::invalid_argument);
  EXPECT_THROW((void)count_removal_support(cloud, cloud, {.min_support_points = -1}), std::invalid_argument);
}

}  // namespace
}  // namespace resight
