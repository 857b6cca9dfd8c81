// SPDX-License-Identifier: Apache-2.0
#include "resight/evidence/object_presence.hpp"

#include <numeric>

#include "resight/core/check.hpp"

namespace resight {
namespace {

// A view with fewer points that are present or seen through says nothing,
constexpr int kMinSeenPoints = 40;
// and neither does one with a smaller share of the points that face the camera.
constexpr double kMinSeenShare = 0.10;
// The object is gone if a larger share of these points is seen through.
constexpr double kMinGoneShare = 0.6;

}  // namespace

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
  result.is_informative = num_seen >= kMinSeenPoints && num_seen >= kMinSeenShare * num_facing;
  result.is_gone = result.is_informative && result.gone_share > kMinGoneShare;
  return result;
}

}  // namespace resight
