// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "resight/geometry/point_cloud.hpp"
#include "resight/geometry/voxel_map.hpp"
#include "resight/sensor/prepared_view.hpp"

namespace resight {

struct IntegrateOptions {
  double voxel_m = 0.005;
  double min_edge_distance_px = 3.0;  ///< Points nearer to a depth discontinuity are dropped (V4R: 3 px).
  int min_points_per_voxel = 1;       ///< Of all views together.
  int num_threads = 1;                ///< Same bits for any value >= 1.
  void check() const;
};

/// What a single view has to say, one point a voxel: the dearer half of integrate_views(). Depends on the view alone: a
/// view that stays as it is need not be reduced again for the next reconstruction. All but the last two are by slot.
struct ViewVoxels {
  std::vector<std::uint64_t> keys;  ///< voxel_key() in the world frame.
  std::vector<int> numbers;         ///< The same in all views that share their VoxelNumbers.
  PointCloud cloud_in_world;        ///< The point of the lowest noise, with normal and colour.
  std::vector<float> noise;         ///< sigma_L^2 sigma_A of it, m^3.
  std::vector<int> num_points;      ///< Points of the view in the voxel; 0 if all of them were taken.
  std::vector<int> first_pixels;    ///< First of them.
  std::vector<int> order;           ///< The slots that hold points, by their first pixels.
  std::vector<int> slot_of_pixel;   ///< Or -1.
};

/// Numbers voxels, 0, 1, 2, .. as they come, whichever view they come from: arrays over numbers stand in for hash
/// tables over voxels. Voxels are looked up in blocks of 4 x 4 x 4, for neighbouring pixels mostly share a block.
class VoxelNumbers {
 public:
  /// Of a voxel, new or known.
  int number_of(std::uint64_t key);
  /// Slot of a voxel in a view, new (with key and number, and nothing else) or known.
  int slot_of(std::uint64_t key, ViewVoxels& view);
  /// Numbers the slots that have none yet.
  void assign_to(ViewVoxels& view);
  [[nodiscard]] std::size_t size() const { return static_cast<std::size_t>(num_voxels_); }
  /// Cubes of 64 voxels of which one is numbered: what the memory goes by.
  [[nodiscard]] std::size_t num_blocks() const { return blocks_.size(); }

 private:
  static constexpr int kNone = -1;
  using Block = std::array<int, 64>;  // Numbers, or kNone.

  VoxelMap block_map_;
  std::vector<Block> blocks_;
  std::uint64_t last_block_key_ = 0;
  std::size_t last_block_ = 0;
  int num_voxels_ = 0;
  std::vector<int> slot_of_number_;  // In the view that was asked about last; of others what is left of them.
};

/// Points without a normal take no part. Ties go to the first pixel.
[[nodiscard]] ViewVoxels reduce_to_voxels(const PreparedView& view, VoxelNumbers& numbers,
                                          const IntegrateOptions& options = {});

/// Brings the voxels up to date with a view from which points were taken (others may have come in: with an edge, the
/// points beside it). Slots stay; new ones are not numbered yet.
void update_voxels(const PreparedView& view, ViewVoxels& voxels, const IntegrateOptions& options = {});

}  // namespace resight
