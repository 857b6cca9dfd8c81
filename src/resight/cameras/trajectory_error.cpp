// SPDX-License-Identifier: Apache-2.0
#include "resight/cameras/trajectory_error.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "resight/core/check.hpp"
#include "resight/registration/pose_estimation.hpp"

namespace resight {
namespace {

// The camera centres and the points 1 m along the axes of each camera, so that rotations count and the motion is
// defined even for a static camera.
std::vector<Eigen::Vector3f> points_of(std::span<const Rigid3> poses) {
  std::vector<Eigen::Vector3f> points;
  for (const Rigid3& pose : poses) {
    points.push_back(pose.translation.cast<float>());
    for (int axis = 0; axis < 3; ++axis)
      points.push_back((pose * Eigen::Vector3d(Eigen::Vector3d::Unit(axis))).cast<float>());
  }
  return points;
}

}  // namespace

TrajectoryError find_trajectory_error(std::span<const Rigid3> reference, std::span<const Rigid3> estimate) {
  require(reference.size() == estimate.size(), "trajectories: must have the same number of views");
  TrajectoryError error;
  error.num_views = static_cast<int>(reference.size());
  if (reference.empty()) return error;
  const std::optional<Rigid3> motion = fit_rigid(points_of(estimate), points_of(reference));
  error.reference_from_estimate = motion ? *motion : reference[0] * estimate[0].inverse();
  double sum_sq = 0;
  for (std::size_t v = 0; v < reference.size(); ++v) {
    const Rigid3 moved = error.reference_from_estimate * estimate[v];
    const double off_m = (moved.translation - reference[v].translation).norm();
    const double off_rad = rotation_angle_rad(moved.rotation, reference[v].rotation);
    sum_sq += off_m * off_m;
    error.max_m = std::max(error.max_m, off_m);
    error.mean_rad += off_rad / static_cast<double>(reference.size());
    error.max_rad = std::max(error.max_rad, off_rad);
  }
  error.rms_m = std::sqrt(sum_sq / static_cast<double>(reference.size()));
  return error;
}

}  // namespace resight
