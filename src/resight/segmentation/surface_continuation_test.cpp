// SPDX-License-Identifier: Apache-2.0
#include "resight/segmentation/surface_continuation.hpp"

#include <gtest/gtest.h>

#include <limits>

namespace resight {
namespace {

using Eigen::Vector3f;

TEST(ContinuesShape, NearTheTangentPlaneWithASimilarNormal) {
  const SurfacePoint from{{0, 0, 1}, -Vector3f::UnitZ()};
  EXPECT_TRUE(continues_shape(from, {{0.02F, 0.01F, 1.004F}, -Vector3f::UnitZ()}, 0.005F));
  EXPECT_TRUE(continues_shape(from, {{0.02F, 0.01F, 0.996F}, -Vector3f::UnitZ()}, 0.005F));
  EXPECT_FALSE(continues_shape(from, {{0.02F, 0.01F, 1.006F}, -Vector3f::UnitZ()}, 0.005F));
  EXPECT_TRUE(continues_shape(from, {{0, 0, 1}, Vector3f(0.3F, 0, -1).normalized()}, 0.005F));
  EXPECT_FALSE(continues_shape(from, {{0, 0, 1}, Vector3f(0.6F, 0, -1).normalized()}, 0.005F));
  EXPECT_FALSE(continues_shape(from, {{0, 0, 1}, Vector3f::UnitZ()}, 0.005F));
  const float nan = std::numeric_limits<float>::quiet_NaN();
  EXPECT_FALSE(continues_shape(from, {{0, 0, nan}, -Vector3f::UnitZ()}, 0.005F));
  EXPECT_FALSE(continues_shape(from, {{0, 0, 1}, Vector3f(nan, nan, nan)}, 0.005F));
}

TEST(ContinuesColor, ByTheToleranceGiven) {
  const LabColor grey{0, 0, 0};
  const LabColor bluer{0, 0, -0.1F};
  EXPECT_TRUE(continues_color(grey, bluer, {0.4, 0.2}));
  EXPECT_FALSE(continues_color(grey, bluer, {0.4, 0.05}));
}

TEST(IsLargerThanObject, ByAFifthOfItsDiameter) {
  EXPECT_TRUE(is_larger_than_object(0.25F, 0.2F));
  EXPECT_FALSE(is_larger_than_object(0.23F, 0.2F));
}

}  // namespace
}  // namespace resight
