// SPDX-License-Identifier: Apache-2.0
#include "resight/geometry/rigid3.hpp"

#include <Eigen/Geometry>
#include <Eigen/SVD>
#include <cmath>

namespace resight {

Rigid3 Rigid3::from_matrix(const Eigen::Matrix4d& m) { return {m.topLeftCorner<3, 3>(), m.topRightCorner<3, 1>()}; }

Rigid3 Rigid3::from_axis_angle(const Eigen::Vector3d& axis, double angle_rad) {
  return from_rotation(Eigen::AngleAxisd(angle_rad, axis.normalized()).toRotationMatrix());
}

Eigen::Matrix4d Rigid3::matrix() const {
  Eigen::Matrix4d m = Eigen::Matrix4d::Identity();
  m.topLeftCorner<3, 3>() = rotation;
  m.topRightCorner<3, 1>() = translation;
  return m;
}

Rigid3 Rigid3::inverse() const { return {rotation.transpose(), -(rotation.transpose() * translation)}; }

bool Rigid3::is_rigid(double tolerance) const {
  return rotation.allFinite() && translation.allFinite() &&
         (rotation * rotation.transpose() - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff() < tolerance &&
         rotation.determinant() > 0;
}

double rotation_angle_rad(const Eigen::Matrix3d& a, const Eigen::Matrix3d& b) {
  // atan2 of the skew part and the trace stays exact near 0 and near pi, where acos loses half of the digits.
  const Eigen::Matrix3d r = a.transpose() * b;
  const Eigen::Vector3d skew(r(2, 1) - r(1, 2), r(0, 2) - r(2, 0), r(1, 0) - r(0, 1));
  return std::atan2(0.5 * skew.norm(), 0.5 * (r.trace() - 1.0));
}

Rigid3 interpolate(const Rigid3& from, const Rigid3& to, double share) {
  const Eigen::Quaterniond rotation = Eigen::Quaterniond(from.rotation).slerp(share, Eigen::Quaterniond(to.rotation));
  return {rotation.normalized().toRotationMatrix(), (1 - share) * from.translation + share * to.translation};
}

bool is_same_pose(const Rigid3& a, const Rigid3& b) {
  constexpr double kTolerance = 1e-6;
  return (a.rotation - b.rotation).cwiseAbs().maxCoeff() < kTolerance &&
         (a.translation - b.translation).cwiseAbs().maxCoeff() < kTolerance;
}

Eigen::Matrix3d nearest_rotation(const Eigen::Matrix3d& m) {
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(m, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Matrix3d u = svd.matrixU();
  if ((u * svd.matrixV().transpose()).determinant() < 0) u.col(2) *= -1;
  return u * svd.matrixV().transpose();
}

}  // namespace resight
