// SPDX-License-Identifier: Apache-2.0
#include "resight/segmentation/smooth_segments.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <span>

#include "resight/core/check.hpp"
#include "resight/core/disjoint_sets.hpp"
#include "resight/core/parallel.hpp"
#include "resight/geometry/block_grid.hpp"

namespace resight {
namespace {

constexpr std::size_t kCellsPerBlock = 512;
constexpr int kNumNeighbors = 27;
constexpr int kOwnCell = 13;  // The numbers of opposite neighbours add up to twice this.

// The cloud in the order of its cells, with cells of side max_distance_m, and the neighbours of each cell. Points that
// are close in space are close in memory, and the neighbours of a point need no look-up.
struct CellOrder {
  std::vector<int> source;  // Index in the original cloud.
  std::vector<Eigen::Vector3f> points;
  std::vector<Eigen::Vector3f> normals;
  std::vector<int> cell_begin;  // CSR over cells.
  // Cell numbers or kNotFound, in (x, y, z) order; the middle one is the cell itself.
  std::vector<std::array<int, kNumNeighbors>> neighbors;
  [[nodiscard]] std::size_t num_cells() const { return neighbors.size(); }
};

CellOrder sort_into_cells(std::span<const Eigen::Vector3f> points, std::span<const Eigen::Vector3f> normals,
                          const SmoothSegmentsOptions& options) {
  const BlockGrid grid(points, options.max_distance_m);
  CellOrder order;
  order.source.reserve(points.size());
  order.points.reserve(points.size());
  order.normals.reserve(points.size());
  order.cell_begin.push_back(0);
  for (std::size_t c = 0; c < grid.num_cells(); ++c) {
    for (const int i : grid.points_of(c)) {
      order.source.push_back(i);
      order.points.push_back(points[i]);
      order.normals.push_back(normals[i]);
    }
    order.cell_begin.push_back(static_cast<int>(order.source.size()));
  }
  order.neighbors.resize(grid.num_cells());
  parallel_for_blocks(grid.num_cells(), kCellsPerBlock, options.num_threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t c = begin; c < end; ++c)
      for (int k = kOwnCell; k < kNumNeighbors; ++k) {
        const Eigen::Vector3i at = grid.cell(c) + Eigen::Vector3i(k / 9 - 1, k / 3 % 3 - 1, k % 3 - 1);
        order.neighbors[c][k] = grid.find(at.x(), at.y(), at.z());
      }
  });
  for (auto& neighbors : order.neighbors) std::fill_n(neighbors.begin(), kOwnCell, VoxelMap::kNotFound);
  for (std::size_t c = 0; c < order.num_cells(); ++c)
    for (int k = kOwnCell + 1; k < kNumNeighbors; ++k)
      if (const int other = order.neighbors[c][k]; other != VoxelMap::kNotFound)
        order.neighbors[other][2 * kOwnCell - k] = static_cast<int>(c);
  return order;
}

// The points of a cell and its neighbours, stored contiguously and tested against a point by vector code.
class Neighborhood {
 public:
  explicit Neighborhood(const CellOrder& cells) : cells_(cells) {}

  // Gathers the points of cell `c` and of its neighbours.
  void gather(std::size_t c) {
    for (std::vector<float>* values : {&x_, &y_, &z_}) values->clear();
    normals_.clear();
    sources_.clear();
    for (const int other : cells_.neighbors[c]) {
      if (other == VoxelMap::kNotFound) continue;
      for (int j = cells_.cell_begin[other]; j < cells_.cell_begin[other + 1]; ++j) add(j);
    }
    is_near_.resize(x_.size());
    near_.resize(x_.size());
  }
  [[nodiscard]] int source(int k) const { return sources_[static_cast<std::size_t>(k)]; }

  // Positions, in ascending order, of the points within the radius of `p`.
  std::span<const int> find_near(const Eigen::Vector3f& p, float radius_sq) {
    mark(x_.data(), y_.data(), z_.data(), p, radius_sq, static_cast<int>(x_.size()), is_near_.data());
    int count = 0;  // Branch-free, because a branch would be unpredictable.
    for (std::size_t k = 0; k < is_near_.size(); ++k) {
      near_[static_cast<std::size_t>(count)] = static_cast<int>(k);
      count += is_near_[k];
    }
    return std::span(near_).first(static_cast<std::size_t>(count));
  }
  [[nodiscard]] const Eigen::Vector4f& normal(int k) const { return normals_[static_cast<std::size_t>(k)]; }

 private:
  void add(int j) {
    x_.push_back(cells_.points[j].x());
    y_.push_back(cells_.points[j].y());
    z_.push_back(cells_.points[j].z());
    normals_.emplace_back(cells_.normals[j].x(), cells_.normals[j].y(), cells_.normals[j].z(), 1.0F);
    sources_.push_back(j);
  }
  // Passes pointers as parameters, because compilers honour __restrict only there.
  static void mark(const float* __restrict x, const float* __restrict y, const float* __restrict z,
                   const Eigen::Vector3f& p, float radius_sq, int count, int* __restrict is_near) {
    const float px = p.x();
    const float py = p.y();
    const float pz = p.z();
    for (int k = 0; k < count; ++k) {
      const float dx = px - x[k];
      const float dy = py - y[k];
      const float dz = pz - z[k];
      is_near[k] = dx * dx + dy * dy + dz * dz <= radius_sq ? 1 : 0;
    }
  }

  const CellOrder& cells_;
  std::vector<float> x_, y_, z_;
  std::vector<Eigen::Vector4f> normals_;  // The fourth component is 1.
  std::vector<int> sources_;              // In the order of the cells.
  std::vector<int> is_near_;              // 1 or 0.
  std::vector<int> near_;
};

// For each point of a block of cells, the later points that are near it and have a similar normal.
struct LaterNeighbors {
  std::vector<int> begin;  // CSR over the points of the block.
  std::vector<int> neighbors;
};

struct Surface {
  // 1 - |mean normal| over each point and its neighbours: 0 on a plane, 0.3 on a right-angled edge.
  std::vector<float> curvatures;
  std::vector<LaterNeighbors> of_block;
};

Surface look_around(const CellOrder& cells, float radius_sq, float min_dot, int num_threads) {
  Surface surface;
  surface.curvatures.resize(cells.points.size());
  surface.of_block.resize((cells.num_cells() + kCellsPerBlock - 1) / kCellsPerBlock);
  parallel_for_blocks(cells.num_cells(), kCellsPerBlock, num_threads, [&](std::size_t begin, std::size_t end) {
    Neighborhood around(cells);
    LaterNeighbors& later = surface.of_block[begin / kCellsPerBlock];
    for (std::size_t c = begin; c < end; ++c) {
      around.gather(c);
      for (int i = cells.cell_begin[c]; i < cells.cell_begin[c + 1]; ++i) {
        Eigen::Vector4f sum = Eigen::Vector4f::Zero();  // Sum of the normals; the last component counts them.
        later.begin.push_back(static_cast<int>(later.neighbors.size()));
        for (const int k : around.find_near(cells.points[i], radius_sq)) {
          sum += around.normal(k);
          if (around.source(k) > i && cells.normals[i].dot(around.normal(k).head<3>()) >= min_dot)
            later.neighbors.push_back(around.source(k));
        }
        surface.curvatures[i] = 1.0F - sum.head<3>().norm() / sum.w();
      }
    }
    later.begin.push_back(static_cast<int>(later.neighbors.size()));
  });
  return surface;
}

// Joins flat neighbours with similar normals.
void join_flat_points(const Surface& surface, float max_curvature, DisjointSets& sets) {
  int i = 0;
  for (const LaterNeighbors& later : surface.of_block)
    for (std::size_t p = 0; p + 1 < later.begin.size(); ++p, ++i) {
      if (surface.curvatures[i] > max_curvature) continue;
      for (int k = later.begin[p]; k < later.begin[p + 1]; ++k)
        if (surface.curvatures[later.neighbors[k]] <= max_curvature) sets.join(i, later.neighbors[k]);
    }
}

// The flat neighbour of an edge point with the most similar normal, or -1. `around` must hold the cell of the point.
int find_host(const CellOrder& cells, Neighborhood& around, int i, const std::vector<float>& curvatures,
              float radius_sq, float max_curvature, float min_dot) {
  int host = -1;
  float best = min_dot;
  for (const int k : around.find_near(cells.points[i], radius_sq)) {
    const int j = around.source(k);
    if (curvatures[j] > max_curvature) continue;
    const float dot = cells.normals[i].dot(cells.normals[j]);
    if (dot < best || (dot == best && host >= 0)) continue;
    best = dot;
    host = j;
  }
  return host;
}

// The host of each edge point. Flat points are their own hosts.
std::vector<int> find_hosts(const CellOrder& cells, const std::vector<float>& curvatures, float radius_sq,
                            float max_curvature, float min_dot, int num_threads) {
  std::vector<int> hosts(cells.points.size());
  parallel_for_blocks(cells.num_cells(), kCellsPerBlock, num_threads, [&](std::size_t begin, std::size_t end) {
    Neighborhood around(cells);
    for (std::size_t c = begin; c < end; ++c) {
      bool gathered = false;
      for (int i = cells.cell_begin[c]; i < cells.cell_begin[c + 1]; ++i) {
        hosts[i] = i;
        if (curvatures[i] <= max_curvature) continue;
        if (!gathered) around.gather(c);
        gathered = true;
        hosts[i] = find_host(cells, around, i, curvatures, radius_sq, max_curvature, min_dot);
      }
    }
  });
  return hosts;
}

SmoothSegments number_segments(const std::vector<int>& root_of, int min_points) {
  std::vector<int> count(root_of.size(), 0);
  for (const int root : root_of)
    if (root >= 0) ++count[root];
  SmoothSegments result;
  std::vector<int> number(root_of.size(), -1);
  result.segment.assign(root_of.size(), -1);
  for (std::size_t i = 0; i < root_of.size(); ++i) {
    const int root = root_of[i];
    if (root < 0 || count[root] < min_points) continue;
    if (number[root] < 0) number[root] = result.num_segments++;
    result.segment[i] = number[root];
  }
  return result;
}

}  // namespace

void SmoothSegmentsOptions::check() const {
  check_positive("SmoothSegmentsOptions.max_distance_m", max_distance_m);
  check_in_range("SmoothSegmentsOptions.max_angle_rad", max_angle_rad, 0, std::numbers::pi / 2);
  check_in_range("SmoothSegmentsOptions.max_curvature", max_curvature, 0, 1);
  check_positive("SmoothSegmentsOptions.min_points", min_points);
  check_positive("SmoothSegmentsOptions.num_threads", num_threads);
}

SmoothSegments find_smooth_segments(std::span<const Eigen::Vector3f> points, std::span<const Eigen::Vector3f> normals,
                                    const SmoothSegmentsOptions& options) {
  require(points.size() == normals.size(), "find_smooth_segments: points and normals differ in number");
  const float max_curvature = static_cast<float>(options.max_curvature);
  const float min_dot = static_cast<float>(std::cos(options.max_angle_rad));
  const float radius_sq = static_cast<float>(options.max_distance_m * options.max_distance_m);
  const CellOrder cells = sort_into_cells(points, normals, options);
  const Surface surface = look_around(cells, radius_sq, min_dot, options.num_threads);
  DisjointSets sets(points.size());
  join_flat_points(surface, max_curvature, sets);
  const std::vector<int> hosts =
      find_hosts(cells, surface.curvatures, radius_sq, max_curvature, min_dot, options.num_threads);
  std::vector<int> root_of(points.size(), -1);  // In the original order; roots are numbers in cell order.
  for (std::size_t i = 0; i < hosts.size(); ++i)
    if (hosts[i] >= 0) root_of[cells.source[i]] = sets.root(hosts[i]);
  return number_segments(root_of, options.min_points);
}

}  // namespace resight
