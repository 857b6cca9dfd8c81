// SPDX-License-Identifier: Apache-2.0
#include "resight/verification/nearest_point_map.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <vector>

#include "resight/core/random.hpp"

namespace resight {
namespace {

Eigen::Vector3f draw(Rng& rng, double half_side_m) {
  const auto one = [&] { return static_cast<float>(rng.uniform(-half_side_m, half_side_m)); };
  const float x = one();
  const float y = one();
  return {x, y, one()};
}

TEST(NearestPointMap, IsAsNearAsTheNearestButForACell) {
  constexpr float kReach_m = 0.02F;
  constexpr float kCell_m = 0.0025F;
  const float slack_m = std::sqrt(3.0F) * kCell_m;  // From the centre to a corner, there and back.
  Rng rng(3);
  std::vector<Eigen::Vector3f> points;
  for (int i = 0; i < 300; ++i) points.push_back(draw(rng, 0.05));
  const NearestPointMap map(points, kReach_m, kCell_m);
  int num_without = 0;
  for (int i = 0; i < 5000; ++i) {
    const Eigen::Vector3f query = draw(rng, 0.08);
    float least_m = std::numeric_limits<float>::infinity();
    for (const Eigen::Vector3f& p : points) least_m = std::min(least_m, (p - query).norm());
    const int found = map.nearest(query);
    if (found < 0) {
      EXPECT_GT(least_m, kReach_m - 0.5F * slack_m);
      ++num_without;
    } else {
      EXPECT_LE((points[static_cast<std::size_t>(found)] - query).norm(), least_m + slack_m);
    }
  }
  EXPECT_GT(num_without, 500);
  EXPECT_LT(num_without, 4500);
}

TEST(NearestPointMap, OfTwoEquallyNearTheFirst) {
  const std::vector<Eigen::Vector3f> points{{0, 0, 0}, {0, 0, 0}};
  EXPECT_EQ(NearestPointMap(points, 0.01F, 0.002F).nearest({0, 0, 0}), 0);
}

TEST(NearestPointMap, KnowsNothingFarAwayAndNothingOfNoPoints) {
  const std::vector<Eigen::Vector3f> points{{0, 0, 0}};
  const NearestPointMap map(points, 0.01F, 0.002F);
  EXPECT_EQ(map.nearest({0, 0, -1}), -1);
  EXPECT_EQ(map.nearest({1e30F, 0, 0}), -1);
  EXPECT_EQ(map.nearest({std::numeric_limits<float>::quiet_NaN(), 0, 0}), -1);
  EXPECT_EQ(NearestPointMap({}, 0.01F, 0.002F).nearest({0, 0, 0}), -1);
  EXPECT_EQ(NearestPointMap().nearest({0, 0, 0}), -1);
}

TEST(NearestPointMap, OfALargeThingHasFewerCells) {
  const std::vector<Eigen::Vector3f> points{{-5, -5, -5}, {5, 5, 5}};
  const NearestPointMap map(points, 1.0F, 1e-3F);
  EXPECT_EQ(map.nearest({4.9F, 4.9F, 4.9F}), 1);
  EXPECT_EQ(map.nearest({-4.9F, -4.9F, -4.9F}), 0);
  EXPECT_EQ(map.nearest({0, 0, 0}), -1);
}

TEST(NearestPointMap, RefusesNoReachAndNoCells) {
  EXPECT_THROW(NearestPointMap({}, 0, 0.002F), std::invalid_argument);
  EXPECT_THROW(NearestPointMap({}, 0.01F, 0), std::invalid_argument);
}

}  // namespace
}  // namespace resight
