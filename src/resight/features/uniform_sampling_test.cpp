// SPDX-License-Identifier: Apache-2.0
#include "resight/features/uniform_sampling.hpp"

#include <gtest/gtest.h>

#include <stdexcept>

namespace resight {
namespace {

using Points = std::vector<Eigen::Vector3f>;

TEST(SampleUniformly, TakesThePointNearestToTheCenterOfEachCubeOnBothSidesOfZero) {
  const Points points{{0.001F, 0.005F, 0.005F},  {-0.009F, 0.005F, 0.005F}, {0.004F, 0.005F, 0.005F},
                      {-0.004F, 0.005F, 0.005F}, {0.009F, 0.005F, 0.005F},  {0.011F, 0.005F, 0.005F}};
  EXPECT_EQ(sample_uniformly(points, 0.01), (std::vector<int>{2, 3, 5}));
}

TEST(SampleUniformly, TakesTheFirstOfEquallyNearPoints) {
  const Points points{{0.25F, 0.5F, 0.5F}, {0.75F, 0.5F, 0.5F}};
  EXPECT_EQ(sample_uniformly(points, 1.0), std::vector<int>{0});
}

TEST(SampleUniformly, TakesNothingFromNothingAndRefusesABadSpacing) {
  EXPECT_TRUE(sample_uniformly(Points{}, 0.01).empty());
  EXPECT_THROW(static_cast<void>(sample_uniformly(Points{}, 0.0)), std::invalid_argument);
}

}  // namespace
}  // namespace resight
