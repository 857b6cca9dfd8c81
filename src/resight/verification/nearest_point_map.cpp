// SPDX-License-Identifier: Apache-2.0
#include "resight/verification/nearest_point_map.hpp"

#include <Eigen/Geometry>
#include <algorithm>

#include "resight/core/check.hpp"

namespace resight {
namespace {

constexpr float kMaxCellsPerAxis = 96;  // At most 3.5 MB per object.

}  // namespace

NearestPointMap::NearestPointMap(std::span<const Eigen::Vector3f> points, float reach_m, float cell_m) {
  check_positive("NearestPointMap: reach_m", reach_m);
  check_positive("NearestPointMap: cell_m", cell_m);
  if (points.empty()) return;
  Eigen::AlignedBox3f box;
  for (const Eigen::Vector3f& p : points) box.extend(p);
  min_ = box.min().array() - reach_m;
  const Eigen::Array3f size = box.sizes().array() + 2 * reach_m;
  const float side_m = std::max(cell_m, size.maxCoeff() / kMaxCellsPerAxis);
  inverse_cell_ = 1 / side_m;
  dims_ = (size * inverse_cell_).cast<int>() + 1;
  const std::size_t num_cells =
      static_cast<std::size_t>(dims_.x()) * static_cast<std::size_t>(dims_.y()) * static_cast<std::size_t>(dims_.z());
  nearest_.assign(num_cells, -1);
  std::vector<float> distance_sq(num_cells, reach_m * reach_m);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Eigen::Array3f at = (points[i] - min_).array();
    const Eigen::Array3i first = ((at - reach_m) * inverse_cell_).cast<int>().max(0);
    const Eigen::Array3i last = ((at + reach_m) * inverse_cell_).cast<int>().min(dims_ - 1);
    for (int x = first.x(); x <= last.x(); ++x)
      for (int y = first.y(); y <= last.y(); ++y)
        for (int z = first.z(); z <= last.z(); ++z) {
          const std::size_t c = flat({x, y, z});
          const Eigen::Array3f center =
              (Eigen::Array3f(static_cast<float>(x), static_cast<float>(y), static_cast<float>(z)) + 0.5F) * side_m;
          const float d = (center - at).matrix().squaredNorm();
          if (d > distance_sq[c] || (d == distance_sq[c] && nearest_[c] >= 0)) continue;
          distance_sq[c] = d;
          nearest_[c] = static_cast<int>(i);
        }
  }
}

}  // namespace resight
