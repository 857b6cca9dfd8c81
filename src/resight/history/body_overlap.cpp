// SPDX-License-Identifier: Apache-2.0
#include "resight/history/body_overlap.hpp"

#include <algorithm>
#include <array>

namespace resight {
namespace {

// Sampled on the way from the centre (0) to each point of the surface (1).
constexpr std::array kDepths = {0.3F, 0.6F, 0.9F};
constexpr std::size_t kMaxSurfacePoints = 300;  // Every n-th point is used beyond: the share is only compared with 0.5.

}  // namespace

double share_within(const ObjectModel& one, const Rigid3& world_from_one, const ObjectModel& other,
                    const Rigid3& world_from_other) {
  const Eigen::Vector3d center = world_from_one * one.center.cast<double>().eval();
  if ((center - world_from_other * other.center.cast<double>().eval()).norm() >
      0.5 * (one.diameter_m + other.diameter_m))
    return 0;
  Eigen::AlignedBox3f box;
  for (const Eigen::Vector3f& p : other.surface.points) box.extend(p);
  const Rigid3f other_from_one(world_from_other.inverse() * world_from_one);
  const std::size_t step = std::max<std::size_t>(1, one.surface.size() / kMaxSurfacePoints);
  int num_points = 0;
  int num_within = 0;
  for (std::size_t i = 0; i < one.surface.size(); i += step)
    for (const float depth : kDepths) {
      ++num_points;
      const Eigen::Vector3f p = one.center + depth * (one.surface.points[i] - one.center);
      if (box.contains(other_from_one * p)) ++num_within;
    }
  return num_points > 0 ? static_cast<double>(num_within) / num_points : 0;
}

bool is_mostly_within(const ObjectModel& one, const Rigid3& world_from_one, const ObjectModel& other,
                      const Rigid3& world_from_other) {
  return share_within(one, world_from_one, other, world_from_other) >= 0.5;
}

double same_body_distance_m(const ObjectModel& model) { return 0.5 * model.diameter_m; }

}  // namespace resight
