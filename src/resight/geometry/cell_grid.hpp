// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <span>
#include <vector>

#include "resight/geometry/voxel_map.hpp"

namespace resight {

/// A cloud sorted into cubes of side `cell_m`, for exact searches around a point. The points of a cube are contiguous
/// in memory. Points that are not finite are left out.
class CellGrid {
 public:
  CellGrid(std::span<const Eigen::Vector3f> points, double cell_m);

  [[nodiscard]] int num_cells() const { return static_cast<int>(cells_.size()); }
  [[nodiscard]] double inverse_cell() const { return inverse_cell_; }
  /// Number of the cell with this index, or VoxelMap::kNotFound.
  [[nodiscard]] int find(int ix, int iy, int iz) const { return cells_.find(voxel_key(ix, iy, iz)); }
  /// Index of the cell that contains a finite point.
  [[nodiscard]] Eigen::Vector3i cell_of(const Eigen::Vector3f& p) const {
    // Double precision, so that rounding never moves a point by a whole cell, however far from the origin it is.
    return {cell_of(p.x()), cell_of(p.y()), cell_of(p.z())};
  }
  [[nodiscard]] std::span<const Eigen::Vector3f> points_of(int cell) const {
    return std::span(points_).subspan(begin_[cell], begin_[cell + 1] - begin_[cell]);
  }
  /// Indices in the original cloud of points_of(cell), ascending.
  [[nodiscard]] std::span<const int> indices_of(int cell) const {
    return std::span(indices_).subspan(begin_[cell], begin_[cell + 1] - begin_[cell]);
  }

 private:
  [[nodiscard]] int cell_of(float x) const {
    // Cells. A cast of more would be undefined; distances are tested all the same.
    constexpr double kFarthest = 1 << 30;
    return static_cast<int>(std::clamp(std::floor(static_cast<double>(x) * inverse_cell_), -kFarthest, kFarthest));
  }

  double inverse_cell_;
  VoxelMap cells_;
  std::vector<int> begin_;               // start of each cell in points_ and indices_, then the end
  std::vector<Eigen::Vector3f> points_;  // cell by cell
  std::vector<int> indices_;
};

}  // namespace resight
