// SPDX-License-Identifier: Apache-2.0
#include "resight/geometry/cell_grid.hpp"

#include "resight/core/check.hpp"

namespace resight {

CellGrid::CellGrid(std::span<const Eigen::Vector3f> points, double cell_m) : inverse_cell_(1.0 / cell_m) {
  check_positive("cell_m", cell_m);
  std::vector<int> cell(points.size(), VoxelMap::kNotFound);
  std::vector<int> count;
  Eigen::Vector3i last_index(0, 0, 0);
  int last_cell = VoxelMap::kNotFound;  // adjacent pixels mostly share a cell, which saves the look-up
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (!points[i].allFinite()) continue;
    const Eigen::Vector3i index = cell_of(points[i]);
    if (last_cell == VoxelMap::kNotFound || index != last_index) {
      last_index = index;
      last_cell = cells_.insert(voxel_key(index.x(), index.y(), index.z()));
      if (last_cell == static_cast<int>(count.size())) count.push_back(0);
    }
    cell[i] = last_cell;
    ++count[last_cell];
  }
  begin_.assign(count.size() + 1, 0);
  for (std::size_t c = 0; c < count.size(); ++c) begin_[c + 1] = begin_[c] + count[c];
  points_.resize(begin_.back());
  indices_.resize(begin_.back());
  std::vector<int> next(begin_.begin(), begin_.end() - 1);
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (cell[i] == VoxelMap::kNotFound) continue;
    const int slot = next[cell[i]]++;
    points_[slot] = points[i];
    indices_[slot] = static_cast<int>(i);
  }
}

}  // namespace resight
