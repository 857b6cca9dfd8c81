// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <vector>

#include "resight/geometry/point_cloud.hpp"
#include "resight/geometry/voxel_map.hpp"

namespace resight {

/// The support points around a keypoint, relative to it, as structure of arrays. The buffers are reused for the next
/// keypoint. Rows from `count` to the next multiple of kLanes are zero, so that sums can run over whole vectors.
struct Neighborhood {
  static constexpr int kLanes = 8;
  int count = 0;
  std::vector<float> dx, dy, dz;  ///< Support point minus keypoint, metres.
  std::vector<float> distance;    ///< Metres, in (0, radius].
  std::vector<float> nx, ny, nz;  ///< Normals of the support points.

  /// Makes room for `capacity` neighbours. Never shrinks.
  void reserve(std::size_t capacity);

  std::vector<float> candidate_distance_sq;  ///< Scratch of SupportGrid::gather().
  std::vector<int> rows;                     ///< Scratch of SupportGrid::gather(): rows of the neighbours in the grid.
};

/// Support points sorted into cubes with the support radius as side, contiguous per cube.
class SupportGrid {
 public:
  /// Leaves out points whose coordinates or normals are not finite.
  SupportGrid(const PointCloud& support, double radius_m);

  /// Number of points in the cubes around `center`: enough capacity for gather().
  [[nodiscard]] std::size_t max_neighbors(const Eigen::Vector3f& center) const;
  /// Gathers all points within the radius of `center`, except those that coincide with it. Ordered by cube, then as in
  /// the cloud.
  void gather(const Eigen::Vector3f& center, Neighborhood& neighborhood) const;

 private:
  template <typename Visit>
  void visit_cells(const Eigen::Vector3f& center, Visit&& visit) const;

  float radius_m_;
  float inverse_size_;
  VoxelMap cells_;
  std::vector<int> cell_begin_;  ///< First point of each cube, then the end.
  std::vector<float> x_, y_, z_, nx_, ny_, nz_;
};

}  // namespace resight
