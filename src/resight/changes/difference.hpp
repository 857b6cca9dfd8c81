// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <span>
#include <vector>

#include "resight/geometry/cell_grid.hpp"

namespace resight {

/// Exact "is there a point within r" on a hash grid: built once over a cloud, asked by many. NaN points are left out.
class ProximityGrid {
 public:
  /// `radius_m` > 0 is the side of the grid's cells and the usual radius of the questions.
  ProximityGrid(std::span<const Eigen::Vector3f> points, double radius_m);
  /// Whether a point lies within the radius (boundary included, squared distance in single precision). False for NaN.
  [[nodiscard]] bool any_within(const Eigen::Vector3f& query) const { return any_within(query, radius_m_); }
  /// The same for another radius, larger or smaller; much larger ones than the grid's get slow.
  [[nodiscard]] bool any_within(const Eigen::Vector3f& query, double radius_m) const;

 private:
  [[nodiscard]] bool is_far(const Eigen::Vector3i& cell) const;

  double radius_m_;
  CellGrid grid_;
  VoxelMap blocks_;  // blocks of cells that lie in or beside an occupied cell
};

/// Eq. (2), A \ B: ascending indices of the points of `a` that have NO point of `b` within `tolerance_m`. Both in one
/// frame. An empty `b` leaves all of `a`. NaN in either is no point: it is neither left over nor does it explain
/// anything.
[[nodiscard]] std::vector<int> subtract_clouds(std::span<const Eigen::Vector3f> a, std::span<const Eigen::Vector3f> b,
                                               double tolerance_m, int num_threads = 1);

/// The same against a grid that was built before, with its radius as the tolerance.
[[nodiscard]] std::vector<int> subtract_clouds(std::span<const Eigen::Vector3f> a, const ProximityGrid& b,
                                               int num_threads = 1);

}  // namespace resight
