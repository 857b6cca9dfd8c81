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

TEST(ContinuesColor, ByLightnessAndChromaticityWhateverTheColor) {
  for (const LabColor from : {LabColor{0, 0, 0}, LabColor{0.2F, 0.5F, -0.4F}}) {
    EXPECT_TRUE(continues_color(from, {from.l + 0.35F, from.a, from.b}));
    EXPECT_FALSE(continues_color(from, {from.l + 0.4F, from.a, from.b}));
    EXPECT_TRUE(continues_color(from, {from.l, from.a + 0.1F, from.b - 0.1F}));
    EXPECT_FALSE(continues_color(from, {from.l, from.a + 0.12F, from.b - 0.12F}));
    EXPECT_FALSE(continues_color(from, {from.l - 0.3F, from.a, from.b + 0.13F}));
    EXPECT_FALSE(continues_color(from, {std::numeric_limits<float>::quiet_NaN(), from.a, from.b}));
  }
}

TEST(IsLargerThanObject, ByAFifthOfItsDiameter) {
  EXPECT_TRUE(is_larger_than_object(0.25F, 0.2F));
  EXPECT_FALSE(is_larger_than_object(0.23F, 0.2F));
}

TEST(WeighSharedTexture, GrowsFromNoneToNearlyOne) {
  EXPECT_EQ(weigh_shared_texture(0, 2), 0);
  EXPECT_DOUBLE_EQ(weigh_shared_texture(2, 2), 0.5);
  EXPECT_DOUBLE_EQ(weigh_shared_texture(6, 2), 0.9);
}

}  // namespace
}  // namespace resight
