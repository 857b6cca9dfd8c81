// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <Eigen/Geometry>
#include <Eigen/LU>

#include "resight/geometry/rigid3.hpp"

namespace resight {

/// A small motion as six numbers: rotation vector (rad), then translation (m).
using Twist = Eigen::Matrix<double, 6, 1>;
/// Covariance of twists, or its inverse, the information.
using TwistMatrix = Eigen::Matrix<double, 6, 6>;

/// Covariance of independent errors that are equal along all axes.
[[nodiscard]] inline TwistMatrix twist_covariance(double sigma_rad, double sigma_m) {
  Twist variances;
  variances << Eigen::Vector3d::Constant(sigma_rad * sigma_rad), Eigen::Vector3d::Constant(sigma_m * sigma_m);
  return variances.asDiagonal();
}
/// Inverse of twist_covariance().
[[nodiscard]] inline TwistMatrix twist_information(double sigma_rad, double sigma_m) {
  return twist_covariance(1 / sigma_rad, 1 / sigma_m);
}

/// Information that remains after adding independent errors of the given sigmas. `least` is added to every direction
/// first, so that unconstrained directions can be inverted.
[[nodiscard]] inline TwistMatrix limit_information(const TwistMatrix& information, double least, double sigma_rad,
                                                   double sigma_m) {
  const TwistMatrix covariance =
      (information + least * TwistMatrix::Identity()).inverse() + twist_covariance(sigma_rad, sigma_m);
  const TwistMatrix limited = covariance.inverse();
  return 0.5 * (limited + limited.transpose());
}

/// Rotation by the rotation vector and translation, applied separately (not the SE(3) exponential).
[[nodiscard]] inline Rigid3 from_twist(const Twist& twist) {
  const Eigen::Vector3d rotation = twist.head<3>();
  const double angle_rad = rotation.norm();
  Rigid3 motion = Rigid3::from_translation(twist.tail<3>());
  if (angle_rad > 0) motion.rotation = Eigen::AngleAxisd(angle_rad, rotation / angle_rad).toRotationMatrix();
  return motion;
}

/// Inverse of from_twist().
[[nodiscard]] inline Twist to_twist(const Rigid3& motion) {
  const Eigen::AngleAxisd rotation(motion.rotation);
  Twist twist;
  twist << rotation.angle() * rotation.axis(), motion.translation;
  return twist;
}

}  // namespace resight
