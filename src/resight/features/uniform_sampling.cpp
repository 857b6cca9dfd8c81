// SPDX-License-Identifier: Apache-2.0
#include "resight/features/uniform_sampling.hpp"

#include "resight/core/check.hpp"
#include "resight/geometry/voxel_map.hpp"

namespace resight {

std::vector<int> sample_uniformly(std::span<const Eigen::Vector3f> points, double spacing_m) {
  check_positive("sample_uniformly: spacing_m", spacing_m);
  const auto inverse_size = static_cast<float>(1.0 / spacing_m);
  VoxelMap cubes(points.size() / 4);
  std::vector<int> nearest;
  std::vector<float> nearest_sq;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Eigen::Vector3f& p = points[i];
    const Eigen::Vector3i index = voxel_index(p, inverse_size);
    const Eigen::Vector3f center = (index.cast<float>().array() + 0.5F) * static_cast<float>(spacing_m);
    const float distance_sq = (p - center).squaredNorm();
    const auto cube = static_cast<std::size_t>(cubes.insert(voxel_key(index.x(), index.y(), index.z())));
    if (cube == nearest.size()) {
      nearest.push_back(static_cast<int>(i));
      nearest_sq.push_back(distance_sq);
    } else if (distance_sq < nearest_sq[cube]) {
      nearest[cube] = static_cast<int>(i);
      nearest_sq[cube] = distance_sq;
    }
  }
  return nearest;
}

}  // namespace resight
