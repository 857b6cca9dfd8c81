// SPDX-License-Identifier: Apache-2.0
#include "resight/verification/point_to_plane.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>

namespace resight {
namespace {

constexpr double kDamping = 1e-3;  // Share of the mean direction that holds those which nothing else does.
constexpr double kStill = 1e-4;    // Metres, and radians times the radius.

using Vector6 = Eigen::Matrix<double, 6, 1>;
using Matrix6 = Eigen::Matrix<double, 6, 6>;

}  // namespace

void StepEquations::add(const Eigen::Vector3d& arm, const Eigen::Vector3d& normal, double residual, double weight,
                        double radius_m) {
  Vector6 row;
  row << arm.cross(normal) / radius_m, normal;
  matrix += weight * row * row.transpose();
  right += weight * residual * row;
  sum_weights += weight;
  sum_residuals_sq += weight * residual * residual;
  ++num_pairs;
}

void StepEquations::add_point(const Eigen::Vector3d& arm, const Eigen::Vector3d& offset, double weight,
                              double radius_m) {
  for (int axis = 0; axis < 3; ++axis) add(arm, Eigen::Vector3d::Unit(axis), offset[axis], weight, radius_m);
}

bool StepEquations::step(Rigid3& pose, const Eigen::Vector3d& middle, double radius_m) const {
  Matrix6 damped = matrix;
  damped.diagonal().array() += kDamping * matrix.trace() / 6;
  const Vector6 x = damped.ldlt().solve(right);
  const Eigen::Vector3d turn = x.head<3>() / radius_m;
  const Eigen::Vector3d moved_middle = pose * middle;
  pose.rotation = Eigen::AngleAxisd(turn.norm(), turn.norm() > 0 ? turn.normalized() : Eigen::Vector3d::UnitX())
                      .toRotationMatrix() *
                  pose.rotation;
  pose.translation = moved_middle + x.tail<3>() - pose.rotation * middle;
  return x.norm() >= kStill;
}

}  // namespace resight
