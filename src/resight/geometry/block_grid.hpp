// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <span>
#include <vector>

#include "resight/geometry/voxel_map.hpp"

namespace resight {

/// Points sorted into cubes of side `cell_m`. The points of one cell are contiguous; cells are in order of their first
/// point.
class BlockGrid {
 public:
  BlockGrid() : BlockGrid({}, 1.0) {}
  BlockGrid(std::span<const Eigen::Vector3f> points, double cell_m);

  [[nodiscard]] std::size_t num_cells() const { return cells_.size(); }
  [[nodiscard]] const Eigen::Vector3i& cell(std::size_t c) const { return cells_[c]; }
  /// Indices of the points of a cell, ascending.
  [[nodiscard]] std::span<const int> points_of(std::size_t c) const {
    return std::span(order_).subspan(begin_[c], begin_[c + 1] - begin_[c]);
  }
  /// Index of the cell at these coordinates, or VoxelMap::kNotFound.
  [[nodiscard]] int find(int ix, int iy, int iz) const { return map_.find(voxel_key(ix, iy, iz)); }
  /// Indices of the points in the closed box, cell by cell. Overwrites `found`. `points` must be those of the
  /// constructor.
  void find_in_box(std::span<const Eigen::Vector3f> points, const Eigen::Vector3f& min, const Eigen::Vector3f& max,
                   std::vector<int>& found) const;

 private:
  float inverse_cell_;
  VoxelMap map_;
  std::vector<Eigen::Vector3i> cells_;
  std::vector<std::size_t> begin_;
  std::vector<int> order_;
};

}  // namespace resight
