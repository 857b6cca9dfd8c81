// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <Eigen/Geometry>

#include "resight/geometry/rigid3.hpp"

namespace resight {

/// A small motion as six numbers: rotation vector (rad), then shift (m).
using Twist = Eigen::Matrix<double, 6, 1>;

[[nodiscard]] inline Rigid3 from_twist(const Twist& twist) {
  const Eigen::Vector3d turn = twist.head<3>();
  const double angle_rad = turn.norm();
  Rigid3 motion = Rigid3::from_translation(twist.tail<3>());
  if (angle_rad > 0) motion.rotation = Eigen::AngleAxisd(angle_rad, turn / angle_rad).toRotationMatrix();
  return motion;
}

[[nodiscard]] inline Twist to_twist(const Rigid3& motion) {
  const Eigen::AngleAxisd turn(motion.rotation);
  Twist twist;
  twist << turn.angle() * turn.axis(), motion.translation;
  return twist;
}

}  // namespace resight
