// SPDX-License-Identifier: Apache-2.0
#include "resight/evidence/object_presence.hpp"

#include <numeric>

#include "resight/core/check.hpp"

namespace resight {

void PresenceOptions::check() const {
  margin.check("PresenceOptions.margin");
  check_positive("PresenceOptions.margin.base_m", margin.base_m);
  check_not_negative("PresenceOptions.min_seen_points", min_seen_points);
  check_in_range("PresenceOptions.min_seen_share", min_seen_share, 0, 1);
  check_in_range("PresenceOptions.min_gone_share", min_gone_share, 0, 1);
}

ObjectPresence assess_presence(const PointCloud& surface_in_object, const Rigid3& world_from_object,
                               const RgbdFrame& frame, const PresenceOptions& options) {
  options.check();
  require(surface_in_object.empty() || surface_in_object.has_normals(), "assess_presence: the surface has no normals");
  const SurfaceEvidence evidence = classify_surface({surface_in_object.points, surface_in_object.normals},
                                                    frame.world_from_camera.inverse() * world_from_object,
                                                    {frame.camera, frame.depth_m}, {.margin = options.margin});
  const int num_through = evidence.num(Evidence::kSeenThrough);
  const int num_seen = evidence.num(Evidence::kPresent) + num_through;
  const int num_facing = std::accumulate(evidence.count.begin(), evidence.count.end(), 0);
  ObjectPresence result;
  result.count = evidence.count;
  result.gone_share = num_seen > 0 ? static_cast<double>(num_through) / num_seen : 0.0;
  result.is_informative = num_seen >= options.min_seen_points && num_seen >= options.min_seen_share * num_facing;
  result.is_gone = result.is_informative && result.gone_share > options.min_gone_share;
  return result;
}

}  // namespace resight
