// SPDX-License-Identifier: Apache-2.0
#include "resight/history/body_overlap.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace resight {
namespace {

// The surface of a box with its bottom at z = 0, points 1 cm apart.
ObjectModel make_box(double x_m, double y_m, double z_m) {
  ObjectModel model;
  const auto steps = [](double size_m) { return static_cast<int>(std::lround(size_m / 0.01)); };
  for (int i = 0; i <= steps(x_m); ++i)
    for (int j = 0; j <= steps(y_m); ++j)
      for (int k = 0; k <= steps(z_m); ++k) {
        const bool on_surface = i == 0 || j == 0 || k == 0 || i == steps(x_m) || j == steps(y_m) || k == steps(z_m);
        if (on_surface) model.surface.points.emplace_back(0.01 * i - x_m / 2, 0.01 * j - y_m / 2, 0.01 * k);
      }
  model.center = Eigen::Vector3f(0, 0, static_cast<float>(z_m / 2));
  model.diameter_m = static_cast<float>(std::sqrt(x_m * x_m + y_m * y_m + z_m * z_m));
  return model;
}

Rigid3 at(double x) { return Rigid3::from_translation({x, 0.2, 0.7}); }

TEST(ShareWithin, TheSamePlaceTouchingAndFarApart) {
  const ObjectModel box = make_box(0.1, 0.1, 0.2);
  EXPECT_DOUBLE_EQ(share_within(box, at(0), box, at(0)), 1.0);
  EXPECT_NEAR(share_within(box, at(0), box, at(0.05)), 0.5, 0.1);
  EXPECT_DOUBLE_EQ(share_within(box, at(0), box, at(0.101)), 0.0);
  EXPECT_DOUBLE_EQ(share_within(box, at(0), box, at(5)), 0.0);
}

TEST(ShareWithin, IsThatOfTheFirst) {
  const ObjectModel can = make_box(0.06, 0.06, 0.1);
  const ObjectModel carton = make_box(0.2, 0.2, 0.3);
  EXPECT_DOUBLE_EQ(share_within(can, at(0), carton, at(0.05)), 1.0);
  EXPECT_LT(share_within(carton, at(0.05), can, at(0)), 0.1);
}

TEST(ShareWithin, RotatesWithTheObject) {
  const ObjectModel plank = make_box(0.4, 0.06, 0.06);
  const Rigid3 across = at(0) * Rigid3::from_axis_angle(Eigen::Vector3d::UnitZ(), M_PI / 2);
  EXPECT_LT(share_within(plank, across, plank, at(0)), 0.35);
  EXPECT_GT(share_within(plank, across, plank, across), 0.99);
}

TEST(ShareWithin, ASurfaceWithoutPointsHasNoBody) {
  const ObjectModel box = make_box(0.1, 0.1, 0.2);
  ObjectModel nothing;
  EXPECT_DOUBLE_EQ(share_within(nothing, at(0), box, at(0)), 0.0);
  EXPECT_DOUBLE_EQ(share_within(box, at(0), nothing, at(0)), 0.0);
}

}  // namespace
}  // namespace resight
