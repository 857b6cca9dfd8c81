// SPDX-License-Identifier: Apache-2.0
#include "resight/changes/difference.hpp"

#include <cmath>
#include <cstdint>

#include "resight/core/check.hpp"
#include "resight/core/parallel.hpp"

namespace resight {
namespace {

// The single-precision distance of two points may be the radius although they are a rounding error farther apart: cells
// are a shade larger than the radius, and the reach in cells is rounded up a (smaller) shade early.
constexpr double kCellSlack = 1.0 + 1e-5;
constexpr double kReachSlack = 1.0 + 1e-6;
constexpr int kBlockShift = 3;  // a block is 8 cells wide
constexpr std::size_t kPointsPerTask = 4096;

bool any_in_cell(std::span<const Eigen::Vector3f> points, const Eigen::Vector3f& query, float radius_sq) {
  for (const Eigen::Vector3f& p : points)
    if ((p - query).squaredNorm() <= radius_sq) return true;
  return false;
}

std::uint64_t block_key(int ix, int iy, int iz) {
  return voxel_key(ix >> kBlockShift, iy >> kBlockShift, iz >> kBlockShift);
}

}  // namespace

ProximityGrid::ProximityGrid(std::span<const Eigen::Vector3f> points, double radius_m)
    : radius_m_((check_positive("radius_m", radius_m), radius_m)), grid_(points, radius_m * kCellSlack) {
  for (int cell = 0; cell < grid_.num_cells(); ++cell) {
    const Eigen::Vector3i c = grid_.cell_of(grid_.points_of(cell).front());
    for (const int dx : {-1, 1})
      for (const int dy : {-1, 1})
        for (const int dz : {-1, 1}) blocks_.insert(block_key(c.x() + dx, c.y() + dy, c.z() + dz));
  }
}

bool ProximityGrid::is_far(const Eigen::Vector3i& cell) const {
  return blocks_.find(block_key(cell.x(), cell.y(), cell.z())) == VoxelMap::kNotFound;
}

bool ProximityGrid::any_within(const Eigen::Vector3f& query, double radius_m) const {
  if (!query.allFinite()) return false;
  const auto radius = static_cast<float>(radius_m);
  const float radius_sq = radius * radius;
  const Eigen::Vector3i c = grid_.cell_of(query);
  // Most points are unchanged and find a neighbour in their own cell.
  const int own = grid_.find(c.x(), c.y(), c.z());
  if (own != VoxelMap::kNotFound && any_in_cell(grid_.points_of(own), query, radius_sq)) return true;
  const int reach = static_cast<int>(std::ceil(radius_m * kReachSlack * grid_.inverse_cell()));
  if (own == VoxelMap::kNotFound && reach <= 1 && is_far(c)) return false;
  for (int dz = -reach; dz <= reach; ++dz) {
    for (int dy = -reach; dy <= reach; ++dy) {
      for (int dx = -reach; dx <= reach; ++dx) {
        if (dx == 0 && dy == 0 && dz == 0) continue;
        const int cell = grid_.find(c.x() + dx, c.y() + dy, c.z() + dz);
        if (cell != VoxelMap::kNotFound && any_in_cell(grid_.points_of(cell), query, radius_sq)) return true;
      }
    }
  }
  return false;
}

std::vector<int> subtract_clouds(std::span<const Eigen::Vector3f> a, const ProximityGrid& b, int num_threads) {
  std::vector<std::uint8_t> left_over(a.size());
  parallel_for_blocks(a.size(), kPointsPerTask, num_threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) left_over[i] = a[i].allFinite() && !b.any_within(a[i]) ? 1 : 0;
  });
  std::vector<int> indices;
  for (std::size_t i = 0; i < a.size(); ++i)
    if (left_over[i] != 0) indices.push_back(static_cast<int>(i));
  return indices;
}

std::vector<int> subtract_clouds(std::span<const Eigen::Vector3f> a, std::span<const Eigen::Vector3f> b,
                                 double tolerance_m, int num_threads) {
  check_positive("tolerance_m", tolerance_m);
  return subtract_clouds(a, ProximityGrid(b, tolerance_m), num_threads);
}

}  // namespace resight
