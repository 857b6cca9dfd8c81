// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <memory>
#include <span>
#include <vector>

namespace resight {

/// A nearest neighbour in a cloud.
struct PointNeighbor {
  int index = -1;
  float distance_sq = 0;  ///< m^2
};

/// Exact nearest neighbours in 3-D (nanoflann). Copies the points. All distances are in metres.
class KdTree {
 public:
  explicit KdTree(std::span<const Eigen::Vector3f> points);
  ~KdTree();
  KdTree(KdTree&&) noexcept;
  KdTree& operator=(KdTree&&) noexcept;

  /// The nearest point; index -1 for an empty cloud or a NaN query.
  [[nodiscard]] PointNeighbor nearest(const Eigen::Vector3f& query) const;
  /// Up to `k` neighbours, nearest first.
  [[nodiscard]] std::vector<PointNeighbor> nearest(const Eigen::Vector3f& query, int k) const;
  /// All points closer than `radius_m`, in ascending order of index. Overwrites `neighbors`.
  void within(const Eigen::Vector3f& query, double radius_m, std::vector<PointNeighbor>& neighbors) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace resight
