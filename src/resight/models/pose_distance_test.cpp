// SPDX-License-Identifier: Apache-2.0
#include "resight/models/pose_distance.hpp"

#include <gtest/gtest.h>

#include <numbers>
#include <stdexcept>

#include "resight/geometry/symmetry.hpp"

namespace resight {
namespace {

constexpr double kPi = std::numbers::pi;

/// A can: every rotation about z, which passes beside the origin through the centre.
ObjectModel can() {
  ObjectModel model;
  model.center = {0.02F, 0, 0.1F};
  model.symmetries.continuous.push_back({.direction = Eigen::Vector3d::UnitZ(), .point = {0.02, 0, 0}});
  return model;
}

TEST(ComparePoses, MeasuresCentreAndRotationOverTheSymmetries) {
  const ObjectModel model = can();
  const Rigid3 reference = Rigid3::from_translation({0.3, 0, 1});
  const Rigid3 about_axis = rotation_about(model.symmetries.continuous.front(), 2);
  const PoseDifference same = compare_poses(reference * about_axis, reference, model);
  EXPECT_NEAR(same.center_distance_m, 0, 1e-9);
  EXPECT_NEAR(same.rotation_rad, 0, 1e-6);
  const Rigid3 tilted =
      Rigid3::from_translation({0, 0.01, 0}) * reference * about_axis * Rigid3::from_translation({0.02, 0, 0.1}) *
      Rigid3::from_axis_angle(Eigen::Vector3d::UnitX(), 0.3) * Rigid3::from_translation({-0.02, 0, -0.1});
  const PoseDifference off = compare_poses(tilted, reference, model);
  EXPECT_NEAR(off.center_distance_m, 0.01, 1e-9);
  EXPECT_NEAR(off.rotation_rad, 0.3, 1e-6);
}

TEST(IsSamePlace, TakesBothLimitsAndTheSymmetriesGiven) {
  const ObjectModel model = can();
  const Rigid3 here = Rigid3::from_translation({0, 0, 1});
  const SamePlaceOptions options{.max_distance_m = 0.03, .max_rotation_rad = 0.2};
  const auto moved = [&](double shift_m, const Eigen::Vector3d& axis, double angle_rad) {
    const Eigen::Vector3d center = model.center.cast<double>();
    return Rigid3::from_translation({shift_m, 0, 0}) * here * Rigid3::from_translation(center) *
           Rigid3::from_axis_angle(axis, angle_rad) * Rigid3::from_translation(-center);
  };
  EXPECT_TRUE(is_same_place(model, here, moved(0.029, Eigen::Vector3d::UnitX(), 0.19), options));
  EXPECT_FALSE(is_same_place(model, here, moved(0.031, Eigen::Vector3d::UnitX(), 0), options));
  EXPECT_FALSE(is_same_place(model, here, moved(0, Eigen::Vector3d::UnitX(), 0.21), options));
  const Rigid3 turned = moved(0, Eigen::Vector3d::UnitZ(), kPi / 2);
  EXPECT_TRUE(is_same_place(model, here, turned, options));
  EXPECT_FALSE(is_same_place(model, ObjectSymmetries{}, here, turned, options));
  EXPECT_THROW(SamePlaceOptions{.max_distance_m = 0}.check(), std::invalid_argument);
}

}  // namespace
}  // namespace resight
