// SPDX-License-Identifier: Apache-2.0
#include "resight/sensor/disparity_error.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace resight {
namespace {

TEST(DisparityError, IsRemovedByTheSameDisparity) {
  constexpr double kBias_per_m = 0.007;
  for (const double z_m : {0.3, 1.2, 4.0}) {
    const double measured_m = 1 / (1 / z_m + kBias_per_m);
    EXPECT_NEAR(without_disparity_error_m(static_cast<float>(measured_m), kBias_per_m), z_m, 1e-6 * z_m);
  }
  EXPECT_EQ(without_disparity_error_m(1.5F, 0), 1.5F);
}

TEST(DisparityError, LeavesNoDepthWhereNoDisparityIsLeft) {
  EXPECT_TRUE(std::isnan(without_disparity_error_m(20, 0.05)));
  EXPECT_TRUE(std::isnan(without_disparity_error_m(25, 0.05)));
  EXPECT_TRUE(std::isnan(without_disparity_error_m(std::nanf(""), 0.01)));
}

TEST(DisparityError, IsRemovedFromAllPixels) {
  RgbdFrame frame{.name = "a", .camera = {}, .color = {}, .depth_m = Image<float>(2, 1, 1.0F), .world_from_camera = {}};
  frame.depth_m(1, 0) = std::nanf("");
  remove_disparity_error(-0.01, frame);
  EXPECT_NEAR(frame.depth_m(0, 0), 1 / 1.01, 1e-6);
  EXPECT_TRUE(std::isnan(frame.depth_m(1, 0)));
}

}  // namespace
}  // namespace resight
