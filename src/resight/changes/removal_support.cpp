// SPDX-License-Identifier: Apache-2.0
#include "resight/changes/removal_support.hpp"

#include <numbers>

#include "resight/core/check.hpp"
#include "resight/core/disjoint_sets.hpp"
#include "resight/geometry/cell_grid.hpp"

namespace resight {
namespace {

bool touch(std::span<const Eigen::Vector3f> a, std::span<const Eigen::Vector3f> b, float distance_sq) {
  for (const Eigen::Vector3f& p : a)
    for (const Eigen::Vector3f& q : b)
      if ((p - q).squaredNorm() <= distance_sq) return true;
  return false;
}

/// Joins a cell with those of its neighbours that hold a point near enough. Cells have a diagonal of the distance: what
/// shares a cell is joined already, and neighbours are at most two cells away.
void join_neighbors(const CellGrid& grid, int cell, float distance_sq, DisjointSets& sets) {
  constexpr int kReach = 2;
  const auto points = grid.points_of(cell);
  const Eigen::Vector3i c = grid.cell_of(points.front());
  for (int dz = -kReach; dz <= kReach; ++dz) {
    for (int dy = -kReach; dy <= kReach; ++dy) {
      for (int dx = -kReach; dx <= kReach; ++dx) {
        const int other = grid.find(c.x() + dx, c.y() + dy, c.z() + dz);
        if (other <= cell || sets.root(other) == sets.root(cell)) continue;  // each pair once; not found is -1
        if (touch(points, grid.points_of(other), distance_sq)) sets.join(cell, other);
      }
    }
  }
}

}  // namespace

std::vector<std::vector<int>> cluster_points(std::span<const Eigen::Vector3f> points, double distance_m,
                                             int min_points) {
  check_positive("distance_m", distance_m);
  // A shade smaller, so that rounding cannot put two points of a cell farther apart than the distance.
  const CellGrid grid(points, distance_m / std::numbers::sqrt3 * (1.0 - 1e-5));
  const auto distance = static_cast<float>(distance_m);
  DisjointSets sets(static_cast<std::size_t>(grid.num_cells()));
  for (int cell = 0; cell < grid.num_cells(); ++cell) join_neighbors(grid, cell, distance * distance, sets);

  std::vector<int> set_of_point(points.size(), -1);
  for (int cell = 0; cell < grid.num_cells(); ++cell)
    for (const int i : grid.indices_of(cell)) set_of_point[i] = sets.root(cell);
  std::vector<std::vector<int>> by_root(static_cast<std::size_t>(grid.num_cells()));
  for (std::size_t i = 0; i < points.size(); ++i)
    if (set_of_point[i] >= 0) by_root[set_of_point[i]].push_back(static_cast<int>(i));
  // A root is the cell of its set that was filled first: the order is that of the first points.
  std::erase_if(by_root,
                [&](const auto& cluster) { return cluster.empty() || static_cast<int>(cluster.size()) < min_points; });
  return by_root;
}

int count_removal_support(const ProximityGrid& surface_in_object, const Rigid3& object_from_world,
                          const PointCloud& removed_in_world, std::span<const std::vector<int>> clusters,
                          const RemovalSupportOptions& options) {
  options.check();
  const Rigid3f motion(object_from_world);
  std::size_t support = 0;
  for (const std::vector<int>& cluster : clusters) {
    std::size_t on_surface = 0;
    for (const int i : cluster)
      on_surface +=
          surface_in_object.any_within(motion * removed_in_world.points[i], options.model_distance_m) ? 1U : 0U;
    const double overlap = static_cast<double>(on_surface) / static_cast<double>(cluster.size());
    if (overlap > options.min_overlap) support += cluster.size();
  }
  return static_cast<int>(support);
}

int count_removal_support(const PointCloud& surface_in_world, const PointCloud& removed_in_world,
                          const RemovalSupportOptions& options) {
  options.check();
  if (surface_in_world.empty() || removed_in_world.empty()) return 0;
  const auto clusters = cluster_points(removed_in_world.points, options.cluster_distance_m, options.min_cluster_points);
  return count_removal_support(ProximityGrid(surface_in_world.points, options.model_distance_m), Rigid3::identity(),
                               removed_in_world, clusters, options);
}

}  // namespace resight
