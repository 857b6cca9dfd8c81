// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "resight/core/image.hpp"
#include "resight/geometry/camera.hpp"
#include "resight/geometry/rigid3.hpp"
#include "resight/geometry/voxel_map.hpp"

namespace resight {

/// What the fusion needs of a view of the object.
struct FusionView {
  Camera camera;
  Rigid3 camera_from_object;
  Image<float> depth_m;
  /// 1 / variance of a point across its surface, in 1/mm^2, less for slanted surface; 0 = not a point of the object, or
  /// one beside an edge. Where there is depth but no weight, the pixel still tells what is free before it.
  Image<float> weight;
  Image<float> slope;  ///< Distance across the surface per depth: the cosine of incidence times the length of the ray.
  Image<Rgb8> color;
};

/// Voxels of a truncated signed distance field, only where surface was seen: blocks of 8 x 8 x 8. Distances are
/// positive outside. The values belong to the voxels' corners: voxel (i, j, k) is the point (i, j, k) * voxel_m.
struct DistanceVolume {
  static constexpr int kSide = 8;
  static constexpr int kVoxels = kSide * kSide * kSide;
  struct Block {
    Eigen::Vector3i index = Eigen::Vector3i::Zero();  ///< Its first voxel is index * kSide.
    std::array<float, kVoxels> distance_m{};
    std::array<float, kVoxels> weight{};  ///< Of that distance.
    std::array<float, kVoxels> seen{};    ///< Weight of the points near it; 0 = none.
    std::array<float, kVoxels> free{};    ///< Weight of the views that looked through.
  };
  double voxel_m = 0.0015;
  double truncation_m = 0.006;
  VoxelMap map;  ///< Of block indices (voxel_key()) to blocks.
  std::vector<Block> blocks;

  [[nodiscard]] const Block* find(const Eigen::Vector3i& index) const {
    const int i = map.find(voxel_key(index.x(), index.y(), index.z()));
    return i == VoxelMap::kNotFound ? nullptr : &blocks[static_cast<std::size_t>(i)];
  }
  [[nodiscard]] static int offset(int x, int y, int z) { return (z * kSide + y) * kSide + x; }
};

/// The blocks around all weighted points, in order of views and pixels.
void allocate_blocks(DistanceVolume& volume, std::span<const FusionView> views);

/// Adds all views to all blocks. Same bits for any number of threads.
void integrate_views(DistanceVolume& volume, std::span<const FusionView> views, int num_threads);

}  // namespace resight
