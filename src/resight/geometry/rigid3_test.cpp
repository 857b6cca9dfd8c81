// SPDX-License-Identifier: Apache-2.0
#include "resight/geometry/rigid3.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "resight/core/random.hpp"

namespace resight {
namespace {

Eigen::Vector3d random_vector(Rng& rng) { return {rng.normal(), rng.normal(), rng.normal()}; }

Rigid3 random_motion(Rng& rng) {
  const double angle_rad = rng.uniform(-3.1, 3.1);
  Rigid3 motion = Rigid3::from_axis_angle(random_vector(rng), angle_rad);
  motion.translation = random_vector(rng);
  return motion;
}

double difference(const Rigid3& a, const Rigid3& b) { return (a.matrix() - b.matrix()).cwiseAbs().maxCoeff(); }

TEST(Rigid3, GroupLaws) {
  Rng rng(1);
  for (int i = 0; i < 200; ++i) {
    const Rigid3 a = random_motion(rng);
    const Rigid3 b = random_motion(rng);
    const Rigid3 c = random_motion(rng);
    const Eigen::Vector3d p = random_vector(rng);
    ASSERT_LT(difference(a * a.inverse(), Rigid3::identity()), 1e-12);
    ASSERT_LT(difference(a.inverse() * a, Rigid3::identity()), 1e-12);
    ASSERT_LT(difference((a * b) * c, a * (b * c)), 1e-12);
    ASSERT_LT(difference((a * b).inverse(), b.inverse() * a.inverse()), 1e-12);
    ASSERT_LT(((a * b) * p - a * (b * p)).norm(), 1e-12);
    ASSERT_LT((a.inverse() * (a * p) - p).norm(), 1e-12);
    ASSERT_TRUE((a * b).is_rigid(1e-9));
  }
}

TEST(Rigid3, AgreesWithHomogeneousMatrices) {
  Rng rng(2);
  const Rigid3 a = random_motion(rng);
  const Rigid3 b = random_motion(rng);
  const Eigen::Vector3d p = random_vector(rng);
  EXPECT_LT(((a.matrix() * b.matrix()) - (a * b).matrix()).norm(), 1e-12);
  EXPECT_LT(((a.matrix() * p.homogeneous()).head<3>() - a * p).norm(), 1e-12);
  EXPECT_EQ(difference(Rigid3::from_matrix(a.matrix()), a), 0);
  EXPECT_LT((Rigid3f(a) * p.cast<float>() - (a * p).cast<float>()).norm(), 1e-5F);
}

TEST(Rigid3, AxisNeedNotBeNormalised) {
  const Rigid3 quarter = Rigid3::from_axis_angle({0, 0, 20}, std::numbers::pi / 2);
  EXPECT_LT((quarter * Eigen::Vector3d(1, 0, 5) - Eigen::Vector3d(0, 1, 5)).norm(), 1e-12);
}

TEST(Rigid3, IsRigidRefusesWhatIsNone) {
  EXPECT_TRUE(Rigid3::identity().is_rigid());
  Rigid3 reflection;
  reflection.rotation(0, 0) = -1;
  Rigid3 scaled;
  scaled.rotation *= 1.01;
  Rigid3 millimetres;
  millimetres.rotation *= 1000;
  Rigid3 sheared;
  sheared.rotation(0, 1) = 0.01;
  Rigid3 nan;
  nan.translation.y() = std::numeric_limits<double>::quiet_NaN();
  Rigid3 infinite;
  infinite.rotation(2, 2) = std::numeric_limits<double>::infinity();
  Rigid3 zero;
  zero.rotation.setZero();
  for (const Rigid3& bad : {reflection, scaled, millimetres, sheared, nan, infinite, zero})
    EXPECT_FALSE(bad.is_rigid());
  EXPECT_TRUE(scaled.is_rigid(0.1));
}

TEST(Rigid3, SamePoseIgnoresRoundingOnly) {
  const Rigid3 pose{Rigid3::from_axis_angle({1, 2, 3}, 0.7).rotation, {0.1, -2, 3}};
  EXPECT_TRUE(is_same_pose(pose, pose.inverse().inverse()));
  EXPECT_FALSE(is_same_pose(pose, pose * Rigid3::from_translation({0, 1e-5, 0})));
  EXPECT_FALSE(is_same_pose(pose, pose * Rigid3::from_axis_angle({0, 0, 1}, 1e-5)));
}

// The quaternion of a very small angle keeps the angle in its vector part without loss.
TEST(RotationAngle, IsExactFromZeroToPi) {
  Rng rng(3);
  const double pi = std::numbers::pi;
  for (const double angle : {0.0, 1e-14, 1e-9, 1e-5, 0.1, 1.0, pi / 2, 2.0, 3.0, pi - 1e-5, pi - 1e-9, pi}) {
    for (int i = 0; i < 20; ++i) {
      const Eigen::Matrix3d a = random_motion(rng).rotation;
      const Eigen::Matrix3d b = a * Rigid3::from_axis_angle(random_vector(rng), angle).rotation;
      ASSERT_NEAR(rotation_angle_rad(a, b), angle, 5e-14) << angle;
      ASSERT_NEAR(rotation_angle_rad(b, a), angle, 5e-14) << angle;
    }
  }
}

TEST(RotationAngle, AgreesWithQuaternionsAndIsInvariant) {
  Rng rng(4);
  for (int i = 0; i < 200; ++i) {
    const Eigen::Matrix3d a = random_motion(rng).rotation;
    const Eigen::Matrix3d b = random_motion(rng).rotation;
    const Eigen::Matrix3d c = random_motion(rng).rotation;
    const double angle = rotation_angle_rad(a, b);
    ASSERT_NEAR(angle, Eigen::Quaterniond(a).angularDistance(Eigen::Quaterniond(b)), 1e-9);
    ASSERT_NEAR(angle, rotation_angle_rad(c * a, c * b), 1e-9);
    ASSERT_NEAR(angle, rotation_angle_rad(a * c, b * c), 1e-9);
    ASSERT_LE(angle, rotation_angle_rad(a, c) + rotation_angle_rad(c, b) + 1e-9);
  }
}

TEST(Interpolate, MovesAtConstantSpeedAlongTheShorterRotation) {
  Rng rng(7);
  for (int i = 0; i < 100; ++i) {
    const Rigid3 a = random_motion(rng);
    const Rigid3 b = random_motion(rng);
    const double angle_rad = rotation_angle_rad(a.rotation, b.rotation);
    for (const double share : {0.0, 0.25, 0.5, 1.0}) {
      const Rigid3 between = interpolate(a, b, share);
      ASSERT_TRUE(between.is_rigid(1e-12));
      ASSERT_NEAR(rotation_angle_rad(a.rotation, between.rotation), share * angle_rad, 1e-7);
      ASSERT_NEAR(rotation_angle_rad(between.rotation, b.rotation), (1 - share) * angle_rad, 1e-7);
      ASSERT_LT((between.translation - a.translation - share * (b.translation - a.translation)).norm(), 1e-12);
    }
  }
}

TEST(NearestRotation, KeepsRotationsAndRepairsRoundedOnes) {
  Rng rng(5);
  for (int i = 0; i < 100; ++i) {
    const Eigen::Matrix3d r = random_motion(rng).rotation;
    ASSERT_LT((nearest_rotation(r) - r).norm(), 1e-12);
    Eigen::Matrix3d rounded = r;
    for (double& x : rounded.reshaped()) x = std::round(x * 1e3) / 1e3;
    const Eigen::Matrix3d repaired = nearest_rotation(rounded);
    ASSERT_TRUE(Rigid3::from_rotation(repaired).is_rigid(1e-12));
    ASSERT_LT(rotation_angle_rad(repaired, r), 2e-3);
    // nearest: at most as far as the true rotation
    ASSERT_LE((repaired - rounded).norm(), (r - rounded).norm() + 1e-12);
  }
}

TEST(NearestRotation, OfAReflectionIsProperAndNearest) {
  Rng rng(6);
  for (int i = 0; i < 20; ++i) {
    Eigen::Matrix3d m = random_motion(rng).rotation;
    m.col(1) *= -0.7;
    const Eigen::Matrix3d nearest = nearest_rotation(m);
    ASSERT_TRUE(Rigid3::from_rotation(nearest).is_rigid(1e-12));
    for (int k = 0; k < 200; ++k) ASSERT_LE((nearest - m).norm(), (random_motion(rng).rotation - m).norm() + 1e-12);
  }
}

}  // namespace
}  // namespace resight
