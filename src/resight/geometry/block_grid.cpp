// SPDX-License-Identifier: Apache-2.0
#include "resight/geometry/block_grid.hpp"

#include "resight/core/check.hpp"

namespace resight {

BlockGrid::BlockGrid(std::span<const Eigen::Vector3f> points, double cell_m)
    : inverse_cell_(static_cast<float>(1.0 / cell_m)), map_(points.size() / 4) {
  check_positive("BlockGrid: cell_m", cell_m);
  std::vector<int> cell_of(points.size());
  std::vector<std::size_t> count;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Eigen::Vector3i c = voxel_index(points[i], inverse_cell_);
    cell_of[i] = map_.insert(voxel_key(c.x(), c.y(), c.z()));
    if (static_cast<std::size_t>(cell_of[i]) == cells_.size()) {
      cells_.push_back(c);
      count.push_back(0);
    }
    ++count[cell_of[i]];
  }
  begin_.assign(cells_.size() + 1, 0);
  for (std::size_t c = 0; c < cells_.size(); ++c) begin_[c + 1] = begin_[c] + count[c];
  std::vector<std::size_t> next(begin_.begin(), begin_.end() - 1);
  order_.resize(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) order_[next[cell_of[i]]++] = static_cast<int>(i);
}

void BlockGrid::find_in_box(std::span<const Eigen::Vector3f> points, const Eigen::Vector3f& min,
                            const Eigen::Vector3f& max, std::vector<int>& found) const {
  found.clear();
  const auto add_cell = [&](std::size_t c) {
    for (const int i : points_of(c))
      if ((points[i].array() >= min.array()).all() && (points[i].array() <= max.array()).all()) found.push_back(i);
  };
  const Eigen::Vector3i first = voxel_index(min, inverse_cell_);
  const Eigen::Vector3i last = voxel_index(max, inverse_cell_);
  const Eigen::Vector3d size = (last - first).cast<double>().array() + 1.0;
  // The box has more cells than are occupied: test the occupied ones.
  if (size.prod() > static_cast<double>(cells_.size())) {
    for (std::size_t c = 0; c < cells_.size(); ++c)
      if ((cells_[c].array() >= first.array()).all() && (cells_[c].array() <= last.array()).all()) add_cell(c);
    return;
  }
  for (int ix = first.x(); ix <= last.x(); ++ix)
    for (int iy = first.y(); iy <= last.y(); ++iy)
      for (int iz = first.z(); iz <= last.z(); ++iz)
        if (const int c = find(ix, iy, iz); c != VoxelMap::kNotFound) add_cell(c);
}

}  // namespace resight
