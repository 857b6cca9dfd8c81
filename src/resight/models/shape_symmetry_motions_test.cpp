// SPDX-License-Identifier: Apache-2.0
#include "resight/models/shape_symmetry_motions.hpp"

#include <gtest/gtest.h>

#include <numbers>

namespace resight {
namespace {

constexpr double kHalfTurn = std::numbers::pi;
const Eigen::Vector3d kX = Eigen::Vector3d::UnitX();
const Eigen::Vector3d kZ = Eigen::Vector3d::UnitZ();

ObjectModel colored() {
  ObjectModel model;
  model.surface.points = {Eigen::Vector3f::Zero()};
  model.surface.colors = {Rgb8{}};
  return model;
}

ObjectSymmetries round_about(const Eigen::Vector3d& axis) {
  return {.discrete = {}, .continuous = {{.direction = axis}}};
}

Rigid3 half_turn(const Eigen::Vector3d& axis) { return Rigid3::from_axis_angle(axis, kHalfTurn); }

TEST(ShapeSymmetryMotions, OfATexturedCanAreAllRotationsInSteps) {
  ObjectModel can = colored();
  can.shape_symmetries = round_about(kZ);
  const std::vector<Rigid3> symmetry_motions = shape_symmetry_motions(can, kHalfTurn / 18);
  ASSERT_EQ(symmetry_motions.size(), 36U);
  EXPECT_EQ(symmetry_motions[0].matrix(), Rigid3::identity().matrix());
  for (const Rigid3& turn : symmetry_motions) EXPECT_NEAR((turn.rotation * kZ - kZ).norm(), 0, 1e-12);
  for (std::size_t i = 1; i < symmetry_motions.size(); ++i)
    EXPECT_NEAR(rotation_angle_rad(symmetry_motions[i - 1].rotation, symmetry_motions[i].rotation), kHalfTurn / 18,
                1e-9);
}

TEST(ShapeSymmetryMotions, SymmetriesOfTheTextureAreNone) {
  ObjectModel can = colored();
  can.symmetries = can.shape_symmetries = round_about(kZ);
  EXPECT_EQ(shape_symmetry_motions(can, 0.1).size(), 1U);
  can.shape_symmetries.discrete.push_back(half_turn(kX));  // Only the lid distinguishes top and bottom.
  EXPECT_EQ(shape_symmetry_motions(can, 0.1).size(), 2U);
}

TEST(ShapeSymmetryMotions, OfABoxAreTheHalfTurnsThatItsTextureDistinguishes) {
  ObjectModel box = colored();
  box.shape_symmetries.discrete = {half_turn(kX), half_turn(Eigen::Vector3d::UnitY()), half_turn(kZ)};
  EXPECT_EQ(shape_symmetry_motions(box, 0.1).size(), 4U);
  box.symmetries.discrete = {half_turn(kZ)};
  EXPECT_EQ(shape_symmetry_motions(box, 0.1).size(), 2U);
}

TEST(ShapeSymmetryMotions, NoneButTheIdentityForABallOrWithoutColors) {
  ObjectModel model = colored();
  model.shape_symmetries = {.discrete = {}, .continuous = {{.direction = kZ}, {.direction = kX}}};
  EXPECT_EQ(shape_symmetry_motions(model, 0.1).size(), 1U);
  model.shape_symmetries = round_about(kZ);
  model.surface.colors.clear();
  EXPECT_EQ(shape_symmetry_motions(model, 0.1).size(), 1U);
}

}  // namespace
}  // namespace resight
