// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "resight/core/options.hpp"
#include "resight/geometry/point_cloud.hpp"
#include "resight/geometry/voxel_map.hpp"
#include "resight/sensor/prepared_view.hpp"

namespace resight {

struct IntegrateOptions {
  double voxel_m = 0.005;
  double min_edge_distance_px = 3.0;
  int min_points_per_voxel = 1;
  int num_threads = 1;  ///< Same bits for any value >= 1.
  void check() const { check_options("IntegrateOptions", *this); }
};

inline void declare(OptionVisitor& v, IntegrateOptions& o) {
  v.field("voxel_m", o.voxel_m, positive(), "Size of a voxel of the reconstruction, which has one point per voxel.",
          "ours; V4R: 0.004");
  v.field("min_edge_distance_px", o.min_edge_distance_px, at_least(0),
          "Points nearer to a depth edge are not integrated. 0: all are.", "V4R");
  v.field("min_points_per_voxel", o.min_points_per_voxel, at_least(1),
          "Voxels with fewer points of all views are empty.");
  v.num_threads(o.num_threads);
}

/// A single view reduced to one point per voxel: the more expensive half of integrate_views(). It depends on the view
/// alone, so an unchanged view need not be reduced again for the next reconstruction. All fields but the last two are
/// per slot.
struct ViewVoxels {
  std::vector<std::uint64_t> keys;  ///< voxel_key() in the world frame.
  std::vector<int> numbers;         ///< Equal for all views that share their VoxelNumbers.
  PointCloud cloud_in_world;        ///< The point with the lowest noise, with normal and colour.
  std::vector<float> noise;         ///< sigma_L^2 sigma_A of this point, m^3.
  std::vector<int> num_points;      ///< Points of the view in the voxel; 0 if all were removed.
  std::vector<int> first_pixels;    ///< First pixel of these points.
  std::vector<int> order;           ///< Slots that hold points, ordered by their first pixels.
  std::vector<int> slot_of_pixel;   ///< Slot of each pixel, or -1.
};

/// Numbers voxels 0, 1, 2, ... in order of appearance, over all views, so that arrays over numbers replace hash tables
/// over voxels. Voxels are looked up in blocks of 4 x 4 x 4, because neighbouring pixels mostly share a block.
class VoxelNumbers {
 public:
  /// Number of a voxel; a new voxel gets the next number.
  int number_of(std::uint64_t key);
  /// Slot of a voxel in a view. A new slot gets its key and number only.
  int slot_of(std::uint64_t key, ViewVoxels& view);
  /// Numbers the slots that have no number yet.
  void assign_to(ViewVoxels& view);
  [[nodiscard]] std::size_t size() const { return static_cast<std::size_t>(num_voxels_); }
  /// Number of blocks of 64 voxels with at least one numbered voxel. Determines the memory.
  [[nodiscard]] std::size_t num_blocks() const { return blocks_.size(); }

 private:
  static constexpr int kNone = -1;
  using Block = std::array<int, 64>;  // Numbers, or kNone.

  VoxelMap block_map_;
  std::vector<Block> blocks_;
  std::uint64_t last_block_key_ = 0;
  std::size_t last_block_ = 0;
  int num_voxels_ = 0;
  // Valid for the view of the last query; other entries are left over from other views.
  std::vector<int> slot_of_number_;
};

/// Throws std::invalid_argument if the images of the view differ in size from its cloud, or it has no normals.
void check_prepared(const PreparedView& view);

/// Reduces a view with normals to voxels. Points without a normal are ignored. In ties, the first pixel wins. Throws
/// std::invalid_argument if the view is not prepared.
[[nodiscard]] ViewVoxels reduce_to_voxels(const PreparedView& view, VoxelNumbers& numbers,
                                          const IntegrateOptions& options = {});

/// Updates the voxels of a view after points were removed. Other points may have been added, for example where an edge
/// has vanished. Slots keep their positions; new ones are not numbered yet. Throws std::invalid_argument for another
/// view.
void update_voxels(const PreparedView& view, ViewVoxels& voxels, const IntegrateOptions& options = {});

}  // namespace resight
