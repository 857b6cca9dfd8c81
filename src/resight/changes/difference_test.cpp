// SPDX-License-Identifier: Apache-2.0
#include "resight/changes/difference.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <stdexcept>

#include "resight/core/random.hpp"

namespace resight {
namespace {

using Points = std::vector<Eigen::Vector3f>;
constexpr float kNoValue = std::numeric_limits<float>::quiet_NaN();
constexpr float kInf = std::numeric_limits<float>::infinity();

bool any_within_slowly(const Points& points, const Eigen::Vector3f& query, double radius_m) {
  const auto radius = static_cast<float>(radius_m);
  for (const Eigen::Vector3f& p : points)
    if ((p - query).squaredNorm() <= radius * radius) return true;
  return false;
}

std::vector<int> subtract_slowly(const Points& a, const Points& b, double tolerance_m) {
  std::vector<int> left_over;
  for (std::size_t i = 0; i < a.size(); ++i)
    if (a[i].allFinite() && !any_within_slowly(b, a[i], tolerance_m)) left_over.push_back(static_cast<int>(i));
  return left_over;
}

Points random_points(int count, double extent_m, std::uint64_t seed, const Eigen::Vector3f& offset = {0, 0, 0}) {
  Rng rng(seed);
  Points points;
  const auto next = [&] { return static_cast<float>(rng.uniform(-extent_m, extent_m)); };
  for (int i = 0; i < count; ++i) points.push_back(offset + Eigen::Vector3f(next(), next(), next()));
  return points;
}

/// Two walls and a floor, 1 cm apart, as a camera would sample them.
Points room_points(double step_m, double shift_m) {
  Points points;
  for (double s = -0.5; s < 0.5; s += step_m)
    for (double t = -0.5; t < 0.5; t += step_m) {
      points.emplace_back(s + shift_m, t, -0.5);
      points.emplace_back(-0.5 + shift_m, s, t);
      points.emplace_back(s, 0.5 + shift_m, t);
    }
  return points;
}

TEST(SubtractClouds, AgreesWithBruteForceOnRandomClouds) {
  for (const double tolerance : {0.01, 0.05, 0.2, 1.5}) {
    for (const double offset : {0.0, -7.3, 250.0}) {
      const Eigen::Vector3f at = Eigen::Vector3f::Constant(static_cast<float>(offset));
      const Points a = random_points(1500, 1, 11, at);
      const Points b = random_points(1500, 1, 12, at);
      const std::vector<int> expected = subtract_slowly(a, b, tolerance);
      EXPECT_EQ(subtract_clouds(a, b, tolerance), expected) << tolerance << " at " << offset;
      if (tolerance == 0.05) {
        EXPECT_GT(expected.size(), 500U);
        EXPECT_LT(expected.size(), 1450U);
      }
    }
  }
}

TEST(SubtractClouds, AgreesWithBruteForceOnSurfaces) {
  const Points a = room_points(0.02, 0);
  for (const double shift : {0.0, 0.004, 0.011, 0.03}) {
    const Points b = room_points(0.02, shift);
    for (const double tolerance : {0.01, 0.012, 0.02})
      EXPECT_EQ(subtract_clouds(a, b, tolerance), subtract_slowly(a, b, tolerance)) << shift << " " << tolerance;
  }
}

TEST(SubtractClouds, BoundaryBelongsToTheNeighbor) {
  // Distances that single precision holds exactly, across cells and on both sides of zero.
  const Points b{{0, 0, 0}};
  for (const float x : {0.25F, -0.25F}) {
    EXPECT_TRUE(subtract_clouds(Points{{x, 0, 0}}, b, 0.25).empty());
    EXPECT_TRUE(subtract_clouds(Points{{0, x, 0}}, b, 0.25).empty());
    EXPECT_TRUE(subtract_clouds(Points{{0, 0, x}}, b, 0.25).empty());
    EXPECT_EQ(subtract_clouds(Points{{std::nextafter(x, 2 * x), 0, 0}}, b, 0.25).size(), 1U);
  }
  EXPECT_TRUE(subtract_clouds(Points{{0.75F, -1, 0}}, Points{{0, 0, 0}}, 1.25).empty());  // 3-4-5
  // A point just below a cell border, whose distance rounds to the tolerance: two cells away without the slack.
  EXPECT_TRUE(subtract_clouds(Points{{-1e-12F, 0, 0}}, Points{{0.25F, 0, 0}}, 0.25).empty());
}

TEST(SubtractClouds, GridOfPointsAtExactlyTheTolerance) {
  Points a;
  Points b;
  for (int x = -6; x <= 6; ++x)
    for (int y = -6; y <= 6; ++y)
      for (int z = -6; z <= 6; ++z) {
        const Eigen::Vector3f p(0.125F * static_cast<float>(x), 0.125F * static_cast<float>(y),
                                0.125F * static_cast<float>(z));
        ((x + y + z) % 4 == 0 ? b : a).push_back(p);
      }
  for (const double tolerance : {0.125, 0.24, 0.25, 0.375})
    EXPECT_EQ(subtract_clouds(a, b, tolerance), subtract_slowly(a, b, tolerance)) << tolerance;
  EXPECT_FALSE(subtract_clouds(a, b, 0.125).empty());
  EXPECT_LT(subtract_clouds(a, b, 0.125).size(), a.size());
}

TEST(SubtractClouds, EmptyDuplicateAndMissingPoints) {
  const Points a{{0, 0, 0}, {1, 0, 0}, {kNoValue, 0, 0}, {0, kInf, 0}, {1, 0, 0}};
  EXPECT_EQ(subtract_clouds(a, Points{}, 0.1), (std::vector<int>{0, 1, 4}));
  EXPECT_TRUE(subtract_clouds(Points{}, a, 0.1).empty());
  EXPECT_TRUE(subtract_clouds(Points{}, Points{}, 0.1).empty());
  const Points b{{1, 0, 0}, {1, 0, 0}, {kNoValue, kNoValue, kNoValue}, {0, kNoValue, 0}, {-kInf, 0, 0}};
  EXPECT_EQ(subtract_clouds(a, b, 0.1), (std::vector<int>{0}));
  EXPECT_TRUE(subtract_clouds(a, a, 0.1).empty());
}

TEST(SubtractClouds, SurvivesCoordinatesBeyondTheGrid) {
  const Points far{{1e30F, -1e30F, 1e12F}, {3e9F, 0, 0}, {0, 0, 0}};
  EXPECT_TRUE(subtract_clouds(far, far, 0.01).empty());
  EXPECT_EQ(subtract_clouds(far, Points{{0, 0, 0}}, 0.01), (std::vector<int>{0, 1}));
}

TEST(SubtractClouds, SerialIsParallel) {
  const Points a = random_points(20000, 0.5, 21);
  const Points b = random_points(5000, 0.5, 22);
  const std::vector<int> serial = subtract_clouds(a, b, 0.02, 1);
  EXPECT_GT(serial.size(), 1000U);
  EXPECT_EQ(subtract_clouds(a, b, 0.02, 2), serial);
  EXPECT_EQ(subtract_clouds(a, b, 0.02, 5), serial);
}

TEST(ProximityGrid, AgreesWithBruteForceForAnyRadius) {
  const Points points = random_points(800, 1, 31);
  const ProximityGrid grid(points, 0.05);
  const Points queries = random_points(1500, 1.2, 32);
  for (const double radius : {0.01, 0.05, 0.0500001, 0.08, 0.1, 0.17}) {
    int num_near = 0;
    for (const Eigen::Vector3f& q : queries) {
      const bool near = grid.any_within(q, radius);
      EXPECT_EQ(near, any_within_slowly(points, q, radius)) << radius;
      num_near += near ? 1 : 0;
    }
    if (radius >= 0.05) {
      EXPECT_GT(num_near, 20) << radius;
    }
    EXPECT_LT(num_near, 1400) << radius;
  }
  EXPECT_FALSE(grid.any_within({kNoValue, 0, 0}));
  EXPECT_FALSE(grid.any_within({0, kInf, 0}));
}

TEST(ProximityGrid, RefusesNonsense) {
  const Points points{{0, 0, 0}};
  EXPECT_THROW(ProximityGrid(points, 0), std::invalid_argument);
  EXPECT_THROW(ProximityGrid(points, -1), std::invalid_argument);
  EXPECT_THROW(ProximityGrid(points, std::nan("")), std::invalid_argument);
  EXPECT_THROW((void)subtract_clouds(points, points, 0), std::invalid_argument);
  EXPECT_THROW((void)subtract_clouds(points, points, 0.1, 0), std::invalid_argument);
}

}  // namespace
}  // namespace resight
