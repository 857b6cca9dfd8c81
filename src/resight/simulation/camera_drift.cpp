// SPDX-License-Identifier: Apache-2.0
#include "resight/simulation/camera_drift.hpp"

#include <cmath>

#include "resight/core/random.hpp"
#include "resight/geometry/angle.hpp"

namespace resight {
namespace {

Eigen::Vector3d draw_normal(Rng& rng) {
  const double x = rng.normal();
  const double y = rng.normal();
  return {x, y, rng.normal()};
}

}  // namespace

std::vector<Rigid3> drift_poses(std::span<const Rigid3> world_from_camera, const CameraDriftOptions& options) {
  options.check();
  Rng rng(options.seed);
  // An autoregressive process of first order with the wanted variance in its stationary state.
  const double kept = std::exp(-1 / options.correlation_views);
  const double added = std::sqrt(1 - kept * kept);
  Eigen::Vector3d position = Eigen::Vector3d::Zero();
  Eigen::Vector3d rotation = Eigen::Vector3d::Zero();
  std::vector<Rigid3> reported;
  for (const Rigid3& pose : world_from_camera) {
    if (!reported.empty()) {
      position = kept * position + added * options.position_sigma_m * draw_normal(rng);
      rotation = kept * rotation + added * radians(options.rotation_sigma_deg) * draw_normal(rng);
    }
    Rigid3 result = pose;
    result.translation += position;
    const double angle_rad = rotation.norm();
    if (angle_rad > 0)
      result.rotation = pose.rotation * Rigid3::from_axis_angle(rotation / angle_rad, angle_rad).rotation;
    reported.push_back(result);
  }
  return reported;
}

}  // namespace resight
