// SPDX-License-Identifier: Apache-2.0
#include "resight/training/internal/rotation_group.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "resight/core/random.hpp"
#include "resight/geometry/rigid3.hpp"

namespace resight::internal {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double kPi = std::numbers::pi;

Matrix3d turn(const Vector3d& axis, int order) { return Rigid3::from_axis_angle(axis, 2 * kPi / order).rotation; }

std::size_t size_of(const std::vector<Matrix3d>& generators) {
  const auto group = generate_rotation_group(generators);
  return group ? group->size() : 0;
}

double distance_to(const std::vector<Matrix3d>& group, const Matrix3d& rotation) {
  double nearest = 10;
  for (const Matrix3d& g : group) nearest = std::min(nearest, (g - rotation).cwiseAbs().maxCoeff());
  return nearest;
}

TEST(RotationGroup, KnownGroupsHaveTheirSize) {
  const double golden = (1 + std::sqrt(5)) / 2;
  EXPECT_EQ(size_of({}), 1U);
  EXPECT_EQ(size_of({turn({0, 0, 1}, 5)}), 5U);
  EXPECT_EQ(size_of({turn({1, 0, 0}, 2), turn({0, 1, 0}, 2)}), 4U);
  EXPECT_EQ(size_of({turn({0, 0, 1}, 6), turn({0, 1, 0}, 2)}), 12U);
  EXPECT_EQ(size_of({turn({1, 1, 1}, 3), turn({0, 0, 1}, 2)}), 12U);       // tetrahedron
  EXPECT_EQ(size_of({turn({1, 1, 1}, 3), turn({0, 0, 1}, 4)}), 24U);       // cube
  EXPECT_EQ(size_of({turn({0, 1, golden}, 5), turn({1, 1, 1}, 3)}), 60U);  // icosahedron
  EXPECT_EQ(size_of({turn({0, 0, 1}, 5), turn({0, 1, 0}, 3)}), 0U)
      << "must not be a group";  // dense in the set of all rotations
}

TEST(RotationGroup, ErrorsOfAFewDegreesAreAveragedAway) {
  Rng rng(1);
  for (int trial = 0; trial < 20; ++trial) {
    std::vector<Matrix3d> generators{turn({1, 1, 1}, 3), turn({0, 0, 1}, 4)};
    for (Matrix3d& g : generators)
      g = g * Rigid3::from_axis_angle({rng.normal(), rng.normal(), rng.normal()}, 0.02).rotation;
    const auto group = generate_rotation_group(generators);
    ASSERT_TRUE(group.has_value());
    ASSERT_EQ(group->size(), 24U);
    EXPECT_EQ(group->front(), Matrix3d::Identity());
    for (const Matrix3d& a : *group)
      for (const Matrix3d& b : *group) ASSERT_LT(distance_to(*group, a * b), 1e-8);
    for (const Matrix3d& g : generators) ASSERT_LT(distance_to(*group, g), 0.06);
  }
}

}  // namespace
}  // namespace resight::internal
