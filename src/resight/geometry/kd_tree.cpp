// SPDX-License-Identifier: Apache-2.0
#include "resight/geometry/kd_tree.hpp"

#include <algorithm>
#include <cstdint>
#include <nanoflann.hpp>

namespace resight {
namespace {

struct Adaptor {
  std::vector<Eigen::Vector3f> points;
  [[nodiscard]] std::size_t kdtree_get_point_count() const { return points.size(); }
  [[nodiscard]] float kdtree_get_pt(std::size_t i, std::size_t axis) const {
    return points[i][static_cast<Eigen::Index>(axis)];
  }
  template <typename Box>
  bool kdtree_get_bbox(Box&) const {
    return false;
  }
};
using Tree =
    nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<float, Adaptor>, Adaptor, 3, std::uint32_t>;

/// A result set of nanoflann that fills the caller's list: its own one would be allocated for each query.
class NeighborsWithin {
 public:
  NeighborsWithin(float radius_sq, std::vector<PointNeighbor>& found) : radius_sq_(radius_sq), found_(found) {}
  [[nodiscard]] std::size_t size() const { return found_.size(); }
  [[nodiscard]] static bool full() { return true; }
  [[nodiscard]] float worstDist() const { return radius_sq_; }
  bool addPoint(float distance_sq, std::uint32_t index) {
    if (distance_sq < radius_sq_) found_.push_back({static_cast<int>(index), distance_sq});
    return true;  // goes on
  }

 private:
  float radius_sq_;
  std::vector<PointNeighbor>& found_;
};

}  // namespace

struct KdTree::Impl {
  explicit Impl(std::span<const Eigen::Vector3f> points)
      : adaptor{{points.begin(), points.end()}}, tree(3, adaptor, nanoflann::KDTreeSingleIndexAdaptorParams(10)) {
    if (!adaptor.points.empty()) tree.buildIndex();
  }
  Adaptor adaptor;
  Tree tree;
};

KdTree::KdTree(std::span<const Eigen::Vector3f> points) : impl_(std::make_unique<Impl>(points)) {}
KdTree::~KdTree() = default;
KdTree::KdTree(KdTree&&) noexcept = default;
KdTree& KdTree::operator=(KdTree&&) noexcept = default;

PointNeighbor KdTree::nearest(const Eigen::Vector3f& query) const {
  if (impl_->adaptor.points.empty()) return {};
  std::uint32_t index = 0;
  float distance_sq = 0;
  if (impl_->tree.knnSearch(query.data(), 1, &index, &distance_sq) == 0) return {};  // a NaN query has no neighbour
  return {static_cast<int>(index), distance_sq};
}

std::vector<PointNeighbor> KdTree::nearest(const Eigen::Vector3f& query, int k) const {
  if (impl_->adaptor.points.empty() || k <= 0) return {};
  std::vector<std::uint32_t> indices(static_cast<std::size_t>(k));
  std::vector<float> distances_sq(static_cast<std::size_t>(k));
  const std::size_t found =
      impl_->tree.knnSearch(query.data(), static_cast<std::size_t>(k), indices.data(), distances_sq.data());
  std::vector<PointNeighbor> result;
  for (std::size_t i = 0; i < found; ++i) result.push_back({static_cast<int>(indices[i]), distances_sq[i]});
  return result;
}

void KdTree::within(const Eigen::Vector3f& query, double radius_m, std::vector<PointNeighbor>& neighbors) const {
  neighbors.clear();
  if (impl_->adaptor.points.empty()) return;
  NeighborsWithin found(static_cast<float>(radius_m * radius_m), neighbors);
  nanoflann::SearchParams params;
  params.sorted = false;
  impl_->tree.radiusSearchCustomCallback(query.data(), found, params);
  std::ranges::sort(neighbors, {}, &PointNeighbor::index);
}

}  // namespace resight
