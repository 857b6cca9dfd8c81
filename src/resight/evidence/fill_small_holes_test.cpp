// SPDX-License-Identifier: Apache-2.0
#include "resight/evidence/fill_small_holes.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace resight {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

TEST(FillSmallHoles, FillsSinglePixelsOnly) {
  Image<float> depth(20, 20, 1.0F);
  depth(5, 5) = kNan;
  for (int v = 10; v < 14; ++v)
    for (int u = 10; u < 14; ++u) depth(u, v) = kNan;
  for (int v = 0; v < 20; ++v)
    for (int u = 0; u < 6; ++u)
      if (depth(u, v) == 1.0F && u == 4) depth(u, v) = 1.2F;
  const Image<float> filled = fill_small_holes(depth);
  EXPECT_EQ(filled(5, 5), 1.0F);
  for (const int i : {10, 13})
    for (int j = 11; j < 13; ++j) {
      EXPECT_TRUE(std::isnan(filled(i, j)));
      EXPECT_TRUE(std::isnan(filled(j, i)));
    }
  EXPECT_EQ(filled(10, 10), 1.0F);  // A hole's convex corner: five neighbours.
  EXPECT_EQ(filled(0, 0), 1.0F);
}

}  // namespace
}  // namespace resight
