// SPDX-License-Identifier: Apache-2.0
#include "resight/geometry/symmetry.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "resight/core/check.hpp"

namespace resight {
namespace {

Rigid3 rotation_about(const ObjectSymmetries::Continuous& symmetry, double angle_rad) {
  return Rigid3::from_translation(symmetry.offset) * Rigid3::from_axis_angle(symmetry.axis, angle_rad) *
         Rigid3::from_translation(-symmetry.offset);
}

// The angle that turns `pose` about the axis as near as possible to `reference`: maximises trace(D Rot(angle)), with
// D = reference^T pose, in closed form (the twist of D^T about the axis).
double best_angle_rad(const Rigid3& pose, const Rigid3& reference, const Eigen::Vector3d& axis) {
  const Eigen::Matrix3d wanted = pose.rotation.transpose() * reference.rotation;
  const Eigen::Quaterniond q(wanted);
  return 2.0 * std::atan2(q.vec().dot(axis.normalized()), q.w());
}

}  // namespace

std::vector<Rigid3> enumerate_symmetries(const ObjectSymmetries& symmetries, double max_step_rad) {
  check_positive("max_step_rad", max_step_rad);
  std::vector<Rigid3> result{Rigid3::identity()};
  for (const auto& c : symmetries.continuous) {
    const int steps = static_cast<int>(std::ceil(2 * std::numbers::pi / max_step_rad - 1e-9));
    const std::vector<Rigid3> base = result;
    for (int i = 1; i < steps; ++i)
      for (const Rigid3& b : base) result.push_back(b * rotation_about(c, 2 * std::numbers::pi * i / steps));
  }
  const std::vector<Rigid3> base = result;
  for (const Rigid3& d : symmetries.discrete)
    for (const Rigid3& b : base) result.push_back(d * b);
  return result;
}

Rigid3 nearest_symmetric_pose(const Rigid3& pose, const Rigid3& reference, const ObjectSymmetries& symmetries) {
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
      consider(candidate * rotation_about(c, best_angle_rad(candidate, reference, c.axis)));
  };
  consider_with_continuous(pose);
  for (const Rigid3& d : symmetries.discrete) consider_with_continuous(pose * d);
  return best;
}

double symmetric_rotation_distance_rad(const Rigid3& a, const Rigid3& b, const ObjectSymmetries& symmetries) {
  return rotation_angle_rad(nearest_symmetric_pose(a, b, symmetries).rotation, b.rotation);
}

}  // namespace resight
