// SPDX-License-Identifier: Apache-2.0
#include "resight/verification/smooth_segments.hpp"

#include <array>
#include <cmath>
#include <numeric>

#include "resight/core/check.hpp"
#include "resight/core/parallel.hpp"
#include "resight/verification/block_grid.hpp"

namespace resight {
namespace {

constexpr std::size_t kCellsPerBlock = 512;

struct Pair {
  int a;
  int b;
  float dot;  // Of the normals.
};
using PairBlocks = std::vector<std::vector<Pair>>;

// One of each two opposite neighbour cells.
constexpr std::array<std::array<int, 3>, 13> kForwardCells = {{{0, 0, 1},
                                                               {0, 1, -1},
                                                               {0, 1, 0},
                                                               {0, 1, 1},
                                                               {1, -1, -1},
                                                               {1, -1, 0},
                                                               {1, -1, 1},
                                                               {1, 0, -1},
                                                               {1, 0, 0},
                                                               {1, 0, 1},
                                                               {1, 1, -1},
                                                               {1, 1, 0},
                                                               {1, 1, 1}}};

// Every pair of points within the radius once, in blocks of cells that do not depend on the number of threads.
PairBlocks find_pairs(std::span<const Eigen::Vector3f> points, std::span<const Eigen::Vector3f> normals,
                      const VerifyOptions& options) {
  const BlockGrid grid(points, options.smooth_distance_m);
  const float radius_sq = static_cast<float>(options.smooth_distance_m * options.smooth_distance_m);
  PairBlocks blocks((grid.num_cells() + kCellsPerBlock - 1) / kCellsPerBlock);
  parallel_for_blocks(grid.num_cells(), kCellsPerBlock, options.num_threads, [&](std::size_t begin, std::size_t end) {
    std::vector<Pair>& pairs = blocks[begin / kCellsPerBlock];
    pairs.reserve((end - begin) * 32);
    const auto add = [&](int i, int j) {
      if ((points[i] - points[j]).squaredNorm() <= radius_sq) pairs.push_back({i, j, normals[i].dot(normals[j])});
    };
    for (std::size_t c = begin; c < end; ++c) {
      const std::span<const int> own = grid.points_of(c);
      for (std::size_t i = 0; i < own.size(); ++i)
        for (std::size_t j = i + 1; j < own.size(); ++j) add(own[i], own[j]);
      for (const auto& [dx, dy, dz] : kForwardCells) {
        const Eigen::Vector3i& at = grid.cell(c);
        const int other = grid.find(at.x() + dx, at.y() + dy, at.z() + dz);
        if (other == VoxelMap::kNotFound) continue;
        for (const int i : own)
          for (const int j : grid.points_of(other)) add(i, j);
      }
    }
  });
  return blocks;
}

// 1 - |mean normal| over each point and its neighbours: 0 on a plane, 0.3 on a right-angled edge.
std::vector<float> find_curvatures(std::span<const Eigen::Vector3f> normals, const PairBlocks& blocks) {
  std::vector<Eigen::Vector3f> sums(normals.begin(), normals.end());
  std::vector<int> counts(normals.size(), 1);
  for (const auto& pairs : blocks)
    for (const Pair& pair : pairs) {
      sums[pair.a] += normals[pair.b];
      sums[pair.b] += normals[pair.a];
      ++counts[pair.a];
      ++counts[pair.b];
    }
  std::vector<float> curvatures(normals.size());
  for (std::size_t i = 0; i < normals.size(); ++i)
    curvatures[i] = 1.0F - sums[i].norm() / static_cast<float>(counts[i]);
  return curvatures;
}

class UnionFind {
 public:
  explicit UnionFind(std::size_t size) : parent_(size) { std::iota(parent_.begin(), parent_.end(), 0); }
  int find(int i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }
  void join(int a, int b) {  // The smaller index is the root.
    a = find(a);
    b = find(b);
    if (a < b) parent_[b] = a;
    if (b < a) parent_[a] = b;
  }

 private:
  std::vector<int> parent_;
};

// For each point on an edge the flat neighbour of the most similar normal, or -1.
std::vector<int> find_hosts(const PairBlocks& blocks, const std::vector<float>& curvatures, float max_curvature,
                            float min_dot) {
  std::vector<int> hosts(curvatures.size(), -1);
  std::vector<float> best(curvatures.size(), min_dot);
  const auto offer = [&](int edge_point, int host, float dot) {
    if (dot < best[edge_point] || (dot == best[edge_point] && hosts[edge_point] >= 0 && hosts[edge_point] < host))
      return;
    best[edge_point] = dot;
    hosts[edge_point] = host;
  };
  for (const auto& pairs : blocks)
    for (const Pair& pair : pairs) {
      const bool flat_a = curvatures[pair.a] <= max_curvature;
      const bool flat_b = curvatures[pair.b] <= max_curvature;
      if (flat_a && !flat_b) offer(pair.b, pair.a, pair.dot);
      if (flat_b && !flat_a) offer(pair.a, pair.b, pair.dot);
    }
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

SmoothSegments find_smooth_segments(std::span<const Eigen::Vector3f> points, std::span<const Eigen::Vector3f> normals,
                                    const VerifyOptions& options) {
  require(points.size() == normals.size(), "find_smooth_segments: points and normals differ in number");
  const float max_curvature = static_cast<float>(options.max_smooth_curvature);
  const float min_dot = static_cast<float>(std::cos(options.smooth_angle_rad));
  const PairBlocks blocks = find_pairs(points, normals, options);
  const std::vector<float> curvatures = find_curvatures(normals, blocks);
  UnionFind sets(points.size());
  for (const auto& pairs : blocks)
    for (const Pair& pair : pairs)
      if (pair.dot >= min_dot && curvatures[pair.a] <= max_curvature && curvatures[pair.b] <= max_curvature)
        sets.join(pair.a, pair.b);
  const std::vector<int> hosts = find_hosts(blocks, curvatures, max_curvature, min_dot);
  std::vector<int> root_of(points.size(), -1);
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (curvatures[i] <= max_curvature)
      root_of[i] = sets.find(static_cast<int>(i));
    else if (hosts[i] >= 0)
      root_of[i] = sets.find(hosts[i]);
  }
  return number_segments(root_of, options.min_smooth_points);
}

}  // namespace resight
