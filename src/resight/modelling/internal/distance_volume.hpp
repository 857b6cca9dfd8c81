// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <span>
#include <vector>

#include "resight/core/image.hpp"
#include "resight/geometry/camera.hpp"
#include "resight/geometry/rigid3.hpp"
#include "resight/geometry/voxel_map.hpp"

namespace resight {

/// What fusion needs of a view of the object.
struct FusionView {
  Camera camera;
  Rigid3 camera_from_object;
  Image<float> depth_m;
  /// Inverse variance of a point across its surface, in 1/mm^2, lower at grazing incidence. 0 = not on the object, or
  /// near a depth edge. Pixels with depth but no weight still observe free space.
  Image<float> weight;
  /// Distance across the surface per unit of depth: cosine of incidence times length of the ray.
  Image<float> slope;
  Image<Rgb8> color;
};

/// Truncated signed distance field, allocated near observed surface only, in blocks of 8 x 8 x 8 voxels. Distances are
/// positive outside. Values are sampled at grid points: voxel (i, j, k) is the point (i, j, k) * voxel_m.
struct DistanceVolume {
  static constexpr int kSide = 8;
  static constexpr int kVoxels = kSide * kSide * kSide;
  struct Block {
    Eigen::Vector3i index = Eigen::Vector3i::Zero();  ///< The first voxel of the block is index * kSide.
    std::array<float, kVoxels> distance_m{};
    std::array<float, kVoxels> weight{};  ///< Weight of distance_m.
    std::array<float, kVoxels> seen{};    ///< Weight of the observed points near the voxel; 0 = none.
    std::array<float, kVoxels> free{};    ///< Weight of the views that observe free space here.
  };
  double voxel_m = 0.0015;
  double truncation_m = 0.006;
  VoxelMap map;  ///< From block indices (voxel_key()) to blocks.
  std::vector<Block> blocks;

  [[nodiscard]] const Block* find(const Eigen::Vector3i& index) const {
    const int i = map.find(voxel_key(index.x(), index.y(), index.z()));
    return i == VoxelMap::kNotFound ? nullptr : &blocks[static_cast<std::size_t>(i)];
  }
  [[nodiscard]] static int offset(int x, int y, int z) { return (z * kSide + y) * kSide + x; }
};

/// Allocates the blocks around all weighted points, in order of views and pixels.
void allocate_blocks(DistanceVolume& volume, std::span<const FusionView> views);

/// Integrates all views into all blocks. Same bits for any number of threads.
void integrate_views(DistanceVolume& volume, std::span<const FusionView> views, int num_threads);

}  // namespace resight
