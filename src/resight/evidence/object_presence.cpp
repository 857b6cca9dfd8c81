// SPDX-License-Identifier: Apache-2.0
#include "resight/evidence/object_presence.hpp"

#include <cmath>

#include "resight/core/check.hpp"
#include "resight/sensor/noise_model.hpp"

namespace resight {
namespace {

Evidence compare(const Eigen::Vector3f& p_in_camera, const RgbdFrame& frame, const PresenceOptions& options) {
  if (!(p_in_camera.z() > 0)) return Evidence::kUnobserved;
  const Eigen::Vector2d pixel = frame.camera.project(p_in_camera.cast<double>());
  if (!frame.camera.contains(pixel)) return Evidence::kUnobserved;
  const float depth_m =
      frame.depth_m(static_cast<int>(std::lround(pixel.x())), static_cast<int>(std::lround(pixel.y())));
  if (std::isnan(depth_m)) return Evidence::kUnobserved;
  const double margin_m = options.depth_margin_m + 3 * nguyen_noise(depth_m, 0.0, frame.camera.fx).axial_m;
  const double behind_m = depth_m - p_in_camera.z();
  if (behind_m > margin_m) return Evidence::kSeenThrough;
  return behind_m < -margin_m ? Evidence::kOccluded : Evidence::kPresent;
}

}  // namespace

void PresenceOptions::check() const {
  check_positive("PresenceOptions.depth_margin_m", depth_margin_m);
  check_not_negative("PresenceOptions.min_seen_points", min_seen_points);
  check_in_range("PresenceOptions.min_seen_share", min_seen_share, 0, 1);
  check_in_range("PresenceOptions.min_gone_share", min_gone_share, 0, 1);
}

ObjectPresence assess_presence(const PointCloud& surface_in_object, const Rigid3& world_from_object,
                               const RgbdFrame& frame, const PresenceOptions& options) {
  options.check();
  require(surface_in_object.empty() || surface_in_object.has_normals(), "assess_presence: the surface has no normals");
  const Rigid3f camera_from_object(frame.world_from_camera.inverse() * world_from_object);
  ObjectPresence result;
  int num_facing = 0;
  for (std::size_t i = 0; i < surface_in_object.size(); ++i) {
    const Eigen::Vector3f p = camera_from_object * surface_in_object.points[i];
    // Below 0.2 (78 deg) the surface is seen edge-on, where depth says little.
    if (-(camera_from_object.rotation * surface_in_object.normals[i]).dot(p) < 0.2F * p.norm()) continue;
    ++num_facing;
    ++result.count[static_cast<std::size_t>(compare(p, frame, options))];
  }
  const int present = result.count[static_cast<std::size_t>(Evidence::kPresent)];
  const int through = result.count[static_cast<std::size_t>(Evidence::kSeenThrough)];
  const int seen = present + through;
  result.gone_share = seen > 0 ? static_cast<double>(through) / seen : 0.0;
  result.is_informative = seen >= options.min_seen_points && seen >= options.min_seen_share * num_facing;
  result.is_gone = result.is_informative && result.gone_share > options.min_gone_share;
  return result;
}

}  // namespace resight
