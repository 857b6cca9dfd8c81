// SPDX-License-Identifier: Apache-2.0
#include "resight/simulation/internal/footprint.hpp"

#include <gtest/gtest.h>

#include <numbers>

namespace resight {
namespace {

constexpr double kQuarter = std::numbers::pi / 2;

TEST(Footprint, OfALyingBoxIsItsSide) {
  TriangleMesh mesh;
  for (const float x : {-0.1F, 0.3F})
    for (const float y : {-0.05F, 0.05F})
      for (const float z : {0.0F, 0.5F}) mesh.vertices.emplace_back(x, y, z);
  const Footprint upright = footprint_of(mesh, 0);
  EXPECT_NEAR(upright.center.x(), 0.1, 1e-6);
  EXPECT_NEAR(upright.half_size.x(), 0.2, 1e-6);
  EXPECT_NEAR(upright.half_size.y(), 0.05, 1e-6);
  const Footprint lying = footprint_of(mesh, kQuarter);  // +z goes to -y
  EXPECT_NEAR(lying.half_size.y(), 0.25, 1e-6);
  EXPECT_NEAR(lying.center.y(), -0.25, 1e-6);
}

TEST(Footprint, OverlapKnowsTurnedRectangles) {
  const Footprint a{{0, 0}, {0.2, 0.05}, 0};
  EXPECT_TRUE(overlaps(a, {{0.3, 0}, {0.2, 0.05}, 0}, 0));
  EXPECT_FALSE(overlaps(a, {{0.3, 0}, {0.2, 0.05}, kQuarter}, 0));  // perpendicular: ends at 0.25
  EXPECT_TRUE(overlaps(a, {{0.3, 0}, {0.2, 0.05}, kQuarter}, 0.06));
  EXPECT_FALSE(overlaps(a, {{0, 0.2}, {0.1, 0.1}, 0}, 0));
  // A square rotated by 45 deg extends sqrt(2) times as far along the axes, and no farther.
  EXPECT_TRUE(overlaps(a, {{0, 0.18}, {0.1, 0.1}, kQuarter / 2}, 0));
  EXPECT_FALSE(overlaps(a, {{0, 0.20}, {0.1, 0.1}, kQuarter / 2}, 0));
  EXPECT_TRUE(overlaps({{0, 0}, {0.5, 0.5}, 0}, {{0, 0}, {0.01, 0.01}, 1}, 0));  // one contains the other
}

TEST(Footprint, LiesWithinCountsTheTurnedExtent) {
  const Eigen::Vector2d area(0.5, 0.2);
  EXPECT_TRUE(lies_within({{0.3, 0}, {0.2, 0.05}, 0}, area));
  EXPECT_FALSE(lies_within({{0.31, 0}, {0.2, 0.05}, 0}, area));
  EXPECT_FALSE(lies_within({{0, 0.01}, {0.2, 0.05}, kQuarter}, area));
  EXPECT_TRUE(lies_within({{0, 0}, {0.2, 0.05}, kQuarter}, area));
}

}  // namespace
}  // namespace resight
