// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <cstddef>
#include <span>
#include <vector>

namespace resight {

/// Lookup table of the nearest point, accurate to a cell. Pays off for many queries to one set of points.
class NearestPointMap {
 public:
  NearestPointMap() = default;
  /// Cells are larger than `cell_m` if there would be too many. Finite points only.
  NearestPointMap(std::span<const Eigen::Vector3f> points, float reach_m, float cell_m);

  /// Index of the point nearest to the centre of the cell that the query is in, the first of equals; -1 if none is
  /// within reach of that centre.
  [[nodiscard]] int nearest(const Eigen::Vector3f& query) const {
    const Eigen::Array3f at = (query - min_).array() * inverse_cell_;
    if (!((at >= 0).all() && (at < dims_.cast<float>()).all())) return -1;
    return nearest_[flat(at.cast<int>())];
  }

 private:
  [[nodiscard]] std::size_t flat(const Eigen::Array3i& cell) const {
    return (static_cast<std::size_t>(cell.x()) * static_cast<std::size_t>(dims_.y()) +
            static_cast<std::size_t>(cell.y())) *
               static_cast<std::size_t>(dims_.z()) +
           static_cast<std::size_t>(cell.z());
  }

  Eigen::Vector3f min_ = Eigen::Vector3f::Zero();
  float inverse_cell_ = 1;
  Eigen::Array3i dims_ = Eigen::Array3i::Zero();
  std::vector<int> nearest_;
};

}  // namespace resight
