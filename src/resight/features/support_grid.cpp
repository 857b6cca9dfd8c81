// SPDX-License-Identifier: Apache-2.0
#include "resight/features/support_grid.hpp"

#include <cmath>
#include <numeric>

#include "resight/core/check.hpp"

namespace resight {
namespace {

// Separate loops with arrays as parameters: compilers honour __restrict only there, and the loops are not vectorised
// without it.
void find_distances_sq(const float* __restrict x, const float* __restrict y, const float* __restrict z, float cx,
                       float cy, float cz, int count, float* __restrict distance_sq) {
  for (int i = 0; i < count; ++i) {
    const float dx = x[i] - cx;
    const float dy = y[i] - cy;
    const float dz = z[i] - cz;
    distance_sq[i] = dx * dx + dy * dy + dz * dz;
  }
}

void pick(const float* __restrict from, float minus, const int* __restrict rows, int count, float* __restrict to) {
  for (int i = 0; i < count; ++i) to[i] = from[rows[i]] - minus;
}

void find_distances(const float* __restrict dx, const float* __restrict dy, const float* __restrict dz, int count,
                    float* __restrict distance) {
  for (int i = 0; i < count; ++i) distance[i] = std::sqrt(dx[i] * dx[i] + dy[i] * dy[i] + dz[i] * dz[i]);
}

}  // namespace

void Neighborhood::reserve(std::size_t capacity) {
  const std::size_t size = capacity + kLanes;
  if (size <= dx.size()) return;
  for (std::vector<float>* values : {&dx, &dy, &dz, &distance, &nx, &ny, &nz, &candidate_distance_sq})
    values->resize(size + size / 2);
  rows.resize(size + size / 2);
}

SupportGrid::SupportGrid(const PointCloud& support, double radius_m)
    : radius_m_(static_cast<float>(radius_m)), inverse_size_(static_cast<float>(1.0 / radius_m)) {
  check_positive("SupportGrid: radius_m", radius_m);
  require(support.empty() || support.has_normals(), "SupportGrid: the support has no normals");
  std::vector<int> members;
  std::vector<int> cell_of_member;
  cell_begin_.assign(1, 0);
  for (std::size_t i = 0; i < support.size(); ++i) {
    if (!support.points[i].allFinite() || !support.normals[i].allFinite()) continue;
    const int cell = cells_.insert(voxel_key(support.points[i], inverse_size_));
    if (static_cast<std::size_t>(cell) + 1 == cell_begin_.size()) cell_begin_.push_back(0);
    ++cell_begin_[static_cast<std::size_t>(cell) + 1];
    members.push_back(static_cast<int>(i));
    cell_of_member.push_back(cell);
  }
  std::partial_sum(cell_begin_.begin(), cell_begin_.end(), cell_begin_.begin());
  for (std::vector<float>* values : {&x_, &y_, &z_, &nx_, &ny_, &nz_}) values->resize(members.size());
  std::vector<int> next(cell_begin_.begin(), cell_begin_.end() - 1);
  for (std::size_t m = 0; m < members.size(); ++m) {
    const int slot = next[cell_of_member[m]]++;
    const Eigen::Vector3f& p = support.points[members[m]];
    const Eigen::Vector3f& n = support.normals[members[m]];
    x_[slot] = p.x();
    y_[slot] = p.y();
    z_[slot] = p.z();
    nx_[slot] = n.x();
    ny_[slot] = n.y();
    nz_[slot] = n.z();
  }
}

template <typename Visit>
void SupportGrid::visit_cells(const Eigen::Vector3f& center, Visit&& visit) const {
  const Eigen::Vector3i index = voxel_index(center, inverse_size_);
  for (int dz = -1; dz <= 1; ++dz)
    for (int dy = -1; dy <= 1; ++dy)
      for (int dx = -1; dx <= 1; ++dx) {
        const int cell = cells_.find(voxel_key(index.x() + dx, index.y() + dy, index.z() + dz));
        if (cell != VoxelMap::kNotFound) visit(cell_begin_[cell], cell_begin_[cell + 1]);
      }
}

std::size_t SupportGrid::max_neighbors(const Eigen::Vector3f& center) const {
  std::size_t sum = 0;
  visit_cells(center, [&](int begin, int end) { sum += static_cast<std::size_t>(end - begin); });
  return sum;
}

void SupportGrid::gather(const Eigen::Vector3f& center, Neighborhood& n) const {
  n.reserve(max_neighbors(center));
  const float radius_sq = radius_m_ * radius_m_;
  int count = 0;
  visit_cells(center, [&](int begin, int end) {
    float* distance_sq = n.candidate_distance_sq.data();
    find_distances_sq(&x_[begin], &y_[begin], &z_[begin], center.x(), center.y(), center.z(), end - begin, distance_sq);
    int* rows = n.rows.data();
    // Branch-free: each row is written, and the next one overwrites a row outside the radius.
    for (int i = begin; i < end; ++i) {
      const float candidate_sq = distance_sq[i - begin];
      rows[count] = i;
      count += static_cast<int>(candidate_sq <= radius_sq) & static_cast<int>(candidate_sq > 0);
    }
  });
  n.count = count;
  pick(x_.data(), center.x(), n.rows.data(), count, n.dx.data());
  pick(y_.data(), center.y(), n.rows.data(), count, n.dy.data());
  pick(z_.data(), center.z(), n.rows.data(), count, n.dz.data());
  pick(nx_.data(), 0, n.rows.data(), count, n.nx.data());
  pick(ny_.data(), 0, n.rows.data(), count, n.ny.data());
  pick(nz_.data(), 0, n.rows.data(), count, n.nz.data());
  find_distances(n.dx.data(), n.dy.data(), n.dz.data(), count, n.distance.data());
  for (int i = count; i < count + Neighborhood::kLanes; ++i) {
    for (std::vector<float>* values : {&n.dx, &n.dy, &n.dz, &n.distance, &n.nx, &n.ny, &n.nz}) (*values)[i] = 0;
  }
}

}  // namespace resight
