// SPDX-License-Identifier: Apache-2.0
#include "resight/geometry/symmetry.hpp"

#include <Eigen/LU>
#include <cmath>
#include <numbers>

#include "resight/core/check.hpp"
#include "resight/geometry/limits.hpp"

namespace resight {
namespace {

// The angle about the axis that rotates `pose` nearest to `reference`. Maximises trace(D Rot(angle)) with D =
// reference^T pose in closed form (the twist of D^T about the axis).
double best_angle_rad(const Rigid3& pose, const Rigid3& reference, const Eigen::Vector3d& axis) {
  const Eigen::Matrix3d wanted = pose.rotation.transpose() * reference.rotation;
  const Eigen::Quaterniond q(wanted);
  return 2.0 * std::atan2(q.vec().dot(axis.normalized()), q.w());
}

int count_steps(double max_step_rad) { return static_cast<int>(std::ceil(2 * std::numbers::pi / max_step_rad - 1e-9)); }

// Two continuous axes that are not parallel generate all rotations: the object is a ball.
bool is_ball(const ObjectSymmetries& symmetries) {
  for (const auto& c : symmetries.continuous)
    if (symmetries.continuous.front().direction.normalized().cross(c.direction.normalized()).norm() > 1e-6) return true;
  return false;
}

// The point nearest to all axes, which intersect in the centre of the ball.
Eigen::Vector3d ball_center(const ObjectSymmetries& symmetries) {
  Eigen::Matrix3d a = Eigen::Matrix3d::Zero();
  Eigen::Vector3d b = Eigen::Vector3d::Zero();
  for (const auto& c : symmetries.continuous) {
    const Eigen::Vector3d axis = c.direction.normalized();
    const Eigen::Matrix3d off_axis = Eigen::Matrix3d::Identity() - axis * axis.transpose();
    a += off_axis;
    b += off_axis * c.point;
  }
  return a.inverse() * b;
}

}  // namespace

Rigid3 rotation_about(const RotationAxis& axis, double angle_rad) {
  return Rigid3::from_translation(axis.point) * Rigid3::from_axis_angle(axis.direction, angle_rad) *
         Rigid3::from_translation(-axis.point);
}

bool is_possible_symmetry(const Rigid3& motion) {
  return motion.is_rigid() && motion.translation.cwiseAbs().maxCoeff() <= 2 * kMaxObjectCoordinate_m;
}

bool is_possible_symmetry(const RotationAxis& axis) {
  const double length = axis.direction.norm();
  return length > 0 && std::isfinite(length) && axis.point.allFinite() &&
         axis.point.cwiseAbs().maxCoeff() <= kMaxObjectCoordinate_m;
}

std::vector<Rigid3> enumerate_symmetries(const ObjectSymmetries& symmetries, double max_step_rad) {
  check_positive("max_step_rad", max_step_rad);
  std::vector<Rigid3> result{Rigid3::identity()};
  for (const auto& c : symmetries.continuous) {
    const int steps = count_steps(max_step_rad);
    const std::vector<Rigid3> base = result;
    for (int i = 1; i < steps; ++i)
      for (const Rigid3& b : base) result.push_back(b * rotation_about(c, 2 * std::numbers::pi * i / steps));
  }
  const std::vector<Rigid3> base = result;
  for (const Rigid3& d : symmetries.discrete)
    for (const Rigid3& b : base) result.push_back(d * b);
  return result;
}

bool has_few_motions(const ObjectSymmetries& symmetries) {
  double num_motions = 1 + static_cast<double>(symmetries.discrete.size());
  for (std::size_t i = 0; i < symmetries.continuous.size() && num_motions <= kMaxSymmetryMotions; ++i)
    num_motions *= count_steps(kSymmetryStep_rad);
  return num_motions <= kMaxSymmetryMotions;
}

Rigid3 nearest_symmetric_pose(const Rigid3& pose, const Rigid3& reference, const ObjectSymmetries& symmetries) {
  if (is_ball(symmetries)) {
    const Eigen::Vector3d center = ball_center(symmetries);
    return {reference.rotation, pose * center - reference.rotation * center};
  }
  Rigid3 best = pose;
  double best_angle = std::numbers::pi * 2;
  const auto consider = [&](const Rigid3& candidate) {
    const double angle = rotation_angle_rad(candidate.rotation, reference.rotation);
    if (angle < best_angle) {
      best_angle = angle;
      best = candidate;
    }
  };
  const auto consider_with_continuous = [&](const Rigid3& candidate) {
    consider(candidate);
    for (const auto& c : symmetries.continuous)
      consider(candidate * rotation_about(c, best_angle_rad(candidate, reference, c.direction)));
  };
  consider_with_continuous(pose);
  for (const Rigid3& d : symmetries.discrete) consider_with_continuous(pose * d);
  return best;
}

double symmetric_rotation_distance_rad(const Rigid3& a, const Rigid3& b, const ObjectSymmetries& symmetries) {
  return rotation_angle_rad(nearest_symmetric_pose(a, b, symmetries).rotation, b.rotation);
}

}  // namespace resight
