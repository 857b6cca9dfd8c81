// SPDX-License-Identifier: Apache-2.0
#include "resight/geometry/symmetry.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>
#include <stdexcept>

#include "resight/core/random.hpp"

namespace resight {
namespace {

constexpr double kPi = std::numbers::pi;

Eigen::Vector3d random_direction(Rng& rng) { return {rng.normal(), rng.normal(), rng.normal()}; }

Rigid3 random_pose(Rng& rng) {
  const double angle_rad = rng.uniform(-3.1, 3.1);
  Rigid3 pose = Rigid3::from_axis_angle(random_direction(rng), angle_rad);
  pose.translation = random_direction(rng);
  return pose;
}

Rigid3 rotation_about_line(const Eigen::Vector3d& point, const Eigen::Vector3d& axis, double angle_rad) {
  return Rigid3::from_translation(point) * Rigid3::from_axis_angle(axis, angle_rad) * Rigid3::from_translation(-point);
}

double pose_difference(const Rigid3& a, const Rigid3& b) { return (a.matrix() - b.matrix()).cwiseAbs().maxCoeff(); }

bool contains(const std::vector<Rigid3>& motions, const Rigid3& wanted) {
  for (const Rigid3& m : motions)
    if (pose_difference(m, wanted) < 1e-9) return true;
  return false;
}

const Eigen::Vector3d kOffset(0.02, -0.01, 0.3);

ObjectSymmetries make_none() { return {}; }
ObjectSymmetries make_square_prism() {  // four-fold about an axis beside the origin
  ObjectSymmetries s;
  for (int i = 1; i < 4; ++i) s.discrete.push_back(rotation_about_line(kOffset, {0, 1, 0}, i * kPi / 2));
  return s;
}
ObjectSymmetries make_bottle() {
  ObjectSymmetries s;
  s.continuous.push_back({.direction = {1, 2, -1}, .point = kOffset});
  return s;
}
ObjectSymmetries make_cylinder() {  // continuous about z, and a half turn about a line through its centre
  ObjectSymmetries s;
  s.continuous.push_back({.direction = {0, 0, 1}, .point = kOffset});
  s.discrete.push_back(rotation_about_line(kOffset, {1, 0, 0}, kPi));
  return s;
}

TEST(RotationAbout, KeepsTheAxisAndTurnsTheRest) {
  const RotationAxis axis{.direction = {0, 0, -3}, .point = {1, 2, 3}};
  const Rigid3 quarter = rotation_about(axis, kPi / 2);
  EXPECT_LT((quarter * axis.point - axis.point).norm(), 1e-12);
  EXPECT_LT((quarter * Eigen::Vector3d(1, 2, -5) - Eigen::Vector3d(1, 2, -5)).norm(), 1e-12);
  EXPECT_LT((quarter * Eigen::Vector3d(2, 2, 7) - Eigen::Vector3d(1, 1, 7)).norm(), 1e-12);
}

TEST(HasFewMotions, CountsWhatEnumerateSymmetriesGives) {
  ObjectSymmetries ball;
  ball.continuous.resize(2);
  ball.continuous[1].direction = Eigen::Vector3d::UnitX();
  EXPECT_EQ(enumerate_symmetries(ball).size(), 72U * 72U);
  for (const ObjectSymmetries& symmetries : {make_none(), make_square_prism(), make_bottle(), make_cylinder(), ball})
    EXPECT_TRUE(has_few_motions(symmetries));
  ObjectSymmetries many = ball;
  many.discrete.resize(3);
  EXPECT_FALSE(has_few_motions(many));
  many.discrete.resize(kMaxSymmetryMotions - 1);
  many.continuous.clear();
  EXPECT_TRUE(has_few_motions(many));
  many.discrete.emplace_back();
  EXPECT_FALSE(has_few_motions(many));
  many.continuous.resize(1000);
  EXPECT_FALSE(has_few_motions(many));
}

TEST(EnumerateSymmetries, AreAGroupOfRigidMotions) {
  for (const ObjectSymmetries& symmetries : {make_none(), make_square_prism(), make_bottle(), make_cylinder()}) {
    const std::vector<Rigid3> motions = enumerate_symmetries(symmetries, kPi / 6);
    ASSERT_FALSE(motions.empty());
    EXPECT_EQ(pose_difference(motions.front(), Rigid3::identity()), 0);
    for (std::size_t i = 0; i < motions.size(); ++i) {
      EXPECT_TRUE(motions[i].is_rigid(1e-9));
      EXPECT_TRUE(contains(motions, motions[i].inverse()));
      for (std::size_t j = 0; j < motions.size(); ++j) {
        EXPECT_TRUE(contains(motions, motions[i] * motions[j]));
        if (i != j) {
          EXPECT_GT(pose_difference(motions[i], motions[j]), 1e-6);
        }
      }
    }
  }
}

TEST(EnumerateSymmetries, CountsAndStep) {
  EXPECT_TRUE(make_none().none());
  EXPECT_FALSE(make_bottle().none());
  EXPECT_EQ(enumerate_symmetries(make_none()).size(), 1U);
  EXPECT_EQ(enumerate_symmetries(make_square_prism()).size(), 4U);
  EXPECT_EQ(enumerate_symmetries(make_bottle(), kPi / 18).size(), 36U);
  EXPECT_EQ(enumerate_symmetries(make_bottle(), 1.0).size(), 7U);  // 6.28 steps of 1 rad are rounded up
  EXPECT_EQ(enumerate_symmetries(make_cylinder(), kPi / 18).size(), 72U);
  EXPECT_THROW((void)enumerate_symmetries(make_bottle(), 0), std::invalid_argument);
}

TEST(EnumerateSymmetries, KeepThePointsOfTheAxis) {
  const ObjectSymmetries bottle = make_bottle();
  const Eigen::Vector3d on_axis = kOffset + 0.7 * bottle.continuous[0].direction;
  for (const Rigid3& m : enumerate_symmetries(bottle)) EXPECT_LT((m * on_axis - on_axis).norm(), 1e-9);
}

// The reference samples the continuous axis in steps of 0.05 deg. The exact answer is never worse, and better by at
// most one step.
TEST(NearestSymmetricPose, IsAtLeastAsGoodAsFineSampling) {
  constexpr double kStep = 0.05 * kPi / 180;
  Rng rng(1);
  for (const ObjectSymmetries& symmetries : {make_square_prism(), make_bottle(), make_cylinder()}) {
    const std::vector<Rigid3> motions = enumerate_symmetries(symmetries, kStep);
    for (int i = 0; i < 12; ++i) {
      const Rigid3 pose = random_pose(rng);
      const Rigid3 reference = random_pose(rng);
      double sampled = 10;
      for (const Rigid3& m : motions)
        sampled = std::min(sampled, rotation_angle_rad((pose * m).rotation, reference.rotation));
      const Rigid3 nearest = nearest_symmetric_pose(pose, reference, symmetries);
      const double angle = rotation_angle_rad(nearest.rotation, reference.rotation);
      ASSERT_LE(angle, sampled + 1e-9);
      ASSERT_GE(angle, sampled - kStep);
      ASSERT_NEAR(symmetric_rotation_distance_rad(pose, reference, symmetries), angle, 1e-12);
    }
  }
}

// The result must be the pose composed with a symmetry, which maps the symmetric body onto itself, translation
// included.
TEST(NearestSymmetricPose, IsASymmetryEquivalentOfThePose) {
  Rng rng(2);
  for (const ObjectSymmetries& symmetries : {make_square_prism(), make_bottle(), make_cylinder()}) {
    for (int i = 0; i < 20; ++i) {
      const Rigid3 pose = random_pose(rng);
      const Rigid3 applied = pose.inverse() * nearest_symmetric_pose(pose, random_pose(rng), symmetries);
      double nearest_motion = 10;
      for (const Rigid3& m : enumerate_symmetries(symmetries, 0.002))
        nearest_motion = std::min(nearest_motion, pose_difference(m, applied));
      ASSERT_LT(nearest_motion, 0.0025);
    }
  }
}

TEST(NearestSymmetricPose, UndoesASymmetryExactly) {
  Rng rng(3);
  for (const ObjectSymmetries& symmetries : {make_square_prism(), make_bottle(), make_cylinder()}) {
    for (const Rigid3& m : enumerate_symmetries(symmetries, 0.7)) {
      const Rigid3 reference = random_pose(rng);
      ASSERT_LT(pose_difference(nearest_symmetric_pose(reference * m, reference, symmetries), reference), 1e-6);
      ASSERT_LT(symmetric_rotation_distance_rad(reference * m, reference, symmetries), 1e-7);
    }
  }
}

TEST(NearestSymmetricPose, WithoutSymmetriesIsThePose) {
  Rng rng(4);
  const Rigid3 pose = random_pose(rng);
  const Rigid3 other = random_pose(rng);
  EXPECT_EQ(pose_difference(nearest_symmetric_pose(pose, other, {}), pose), 0);
  EXPECT_NEAR(symmetric_rotation_distance_rad(pose, other, {}), rotation_angle_rad(pose.rotation, other.rotation),
              1e-12);
}

TEST(NearestSymmetricPose, OfABallTakesTheReferencesRotationAboutItsCentre) {
  ObjectSymmetries ball;
  ball.continuous.push_back({.direction = {1, 0, 0}, .point = {5, 0.2, 0.3}});
  ball.continuous.push_back({.direction = {0, 0, 2}, .point = {0.1, 0.2, -4}});
  const Eigen::Vector3d center(0.1, 0.2, 0.3);
  Rng rng(5);
  const Rigid3 pose = random_pose(rng);
  const Rigid3 reference = random_pose(rng);
  const Rigid3 nearest = nearest_symmetric_pose(pose, reference, ball);
  EXPECT_LT(rotation_angle_rad(nearest.rotation, reference.rotation), 1e-12);
  EXPECT_LT((nearest * center - pose * center).norm(), 1e-9);
}

TEST(SymmetricRotationDistance, IsSymmetricInItsPoses) {
  Rng rng(6);
  for (const ObjectSymmetries& symmetries : {make_square_prism(), make_bottle(), make_cylinder()})
    for (int i = 0; i < 20; ++i) {
      const Rigid3 a = random_pose(rng);
      const Rigid3 b = random_pose(rng);
      ASSERT_NEAR(symmetric_rotation_distance_rad(a, b, symmetries), symmetric_rotation_distance_rad(b, a, symmetries),
                  1e-7);
    }
}

}  // namespace
}  // namespace resight
