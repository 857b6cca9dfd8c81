// SPDX-License-Identifier: Apache-2.0
#include "resight/modelling/coverage.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "resight/rendering/view_renderer.hpp"

namespace resight {
namespace {

constexpr double kPi = std::numbers::pi;

std::vector<Rigid3> ring(double elevation_rad, int count) {
  std::vector<Rigid3> poses;
  for (int i = 0; i < count; ++i) {
    const double a = 2 * kPi * i / count;
    poses.push_back(look_at(
        {std::cos(a) * std::cos(elevation_rad), std::sin(a) * std::cos(elevation_rad), std::sin(elevation_rad) + 0.1},
        {0, 0, 0.1}));
  }
  return poses;
}

TEST(Coverage, OfOneViewIsACap) {
  const std::vector<Rigid3> poses = ring(0, 1);
  const double angle = kPi / 12;
  const ViewCoverage coverage = measure_coverage(poses, {0, 0, 0.1}, angle);
  EXPECT_NEAR(coverage.share, 0.5 * (1 - std::cos(angle)), 0.002);
  EXPECT_NEAR(coverage.largest_gap_rad, kPi, 0.05);
  EXPECT_LT(coverage.largest_gap.x(), -0.99);
}

TEST(Coverage, OfADenseRingIsABandAboveOnly) {
  const double elevation = kPi / 6;
  const double angle = kPi / 12;
  const ViewCoverage coverage = measure_coverage(ring(elevation, 180), {0, 0, 0.1}, angle);
  const double band = std::sin(elevation + angle) - std::sin(elevation - angle);
  EXPECT_NEAR(coverage.share_above, band, 0.005);
  EXPECT_EQ(coverage.share_below, 0);
  EXPECT_NEAR(coverage.share, 0.5 * band, 0.005);
  EXPECT_LT(coverage.largest_gap.z(), -0.99);
  EXPECT_NEAR(coverage.largest_gap_rad, kPi / 2 + elevation, 0.05);
}

TEST(Coverage, WithoutViewsIsNone) { EXPECT_EQ(measure_coverage({}, {0, 0, 0}).share, 0); }

TEST(KeyViews, AreNotNearerThanTheAngle) {
  const std::vector<Rigid3> poses = ring(0, 36);
  const std::vector<int> chosen = choose_key_views(poses, {0, 0, 0.1}, 15 * kPi / 180);
  ASSERT_EQ(chosen.size(), 18U);  // Every 20 deg.
  EXPECT_EQ(chosen[1], 2);
  EXPECT_EQ(choose_key_views(poses, {0, 0, 0.1}, 0).size(), 36U);
}

}  // namespace
}  // namespace resight
