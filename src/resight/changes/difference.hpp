// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <span>
#include <vector>

namespace resight {

/// Exact "is there a point within r" on a hash grid: built once over a cloud, asked by many. r is fixed at construction.
class ProximityGrid {
 public:
  ProximityGrid(std::span<const Eigen::Vector3f> points, double radius_m);
  /// Whether a point lies within the radius (boundary included). False for NaN.
  [[nodiscard]] bool any_within(const Eigen::Vector3f& query) const;

 private:
  float inverse_cell_;
  float radius_sq_;
  // cells in CSR form; filled by the constructor
  std::vector<int> cell_begin_;
  std::vector<Eigen::Vector3f> points_;
  struct Cells;
};

/// Eq. (2), A \ B: ascending indices of the points of `a` that have NO point of `b` within `tolerance_m`. Both in one frame.
/// An empty `b` leaves all of `a`.
[[nodiscard]] std::vector<int> subtract_clouds(std::span<const Eigen::Vector3f> a, std::span<const Eigen::Vector3f> b,
                                               double tolerance_m, int num_threads = 1);

}  // namespace resight
