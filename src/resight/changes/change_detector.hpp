// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "resight/geometry/point_cloud.hpp"
#include "resight/sensor/prepared_view.hpp"

namespace resight {

/// What a view says about a point of the past. Absence needs evidence: only kSeenThrough may remove a point.
enum class Evidence : std::uint8_t { kUnobserved, kOccluded, kPresent, kSeenThrough };

struct DetectChangesOptions {
  double tolerance_m = 0.02;           ///< epsilon of Eq. (2); V4R: 2 cm as called.
  double voxel_m = 0.005;              ///< Both clouds are thinned to this first (V4R: 5 mm).
  double bin_size_rad = 0.0349066;     ///< Of the spherical z-buffer; paper: 2 deg.
  double occlusion_margin_m = 0.0;     ///< A blocker hides what is farther by more than this. Paper: 0.
  double min_depth_m = 0.5;            ///< View volume (V4R: Xtion, 0.5 to 3.5 m).
  double max_depth_m = 3.5;
  double frustum_margin_rad = 0.0872665;
  double max_changed_share = 0.5;      ///< More of the visible surface changed: the camera pose is suspect, and nothing is removed.
  int num_threads = 1;                 ///< Same bits for any value >= 1.
  void check() const;
};

/// Changes of one view against the reconstruction before it.
struct ChangeResult {
  PointCloud novel_in_world;           ///< N of Eq. (3): S_k \ Psi, where Psi could have had a point.
  PointCloud removed_in_world;         ///< D of Alg. 1, line 3.
  Image<std::uint8_t> novel_mask;      ///< Non-zero at the novel pixels of the view.
  std::array<int, 4> evidence_count{}; ///< Of the points of Psi, by Evidence.
  double changed_share = 0;            ///< Removed / (removed + present).
  bool pose_suspect = false;           ///< See max_changed_share; novel and removed are then empty.
};

/// Alg. 1, lines 1 to 3 and Eq. (3): `previous_in_world` is Psi_{k-1} (empty: the first view, no changes).
[[nodiscard]] ChangeResult detect_changes(const PointCloud& previous_in_world, const PreparedView& view, const DetectChangesOptions& options = {});

/// Which removal is later than which view. A removal clears only views taken BEFORE it, so that an object put back at its old
/// place survives.
class RemovalHistory {
 public:
  /// `view_index` in ascending order.
  void add(int view_index, PointCloud removed_in_world);
  /// Union of what was removed in views later than `view_index`.
  [[nodiscard]] PointCloud removed_after(int view_index) const;
  /// What the view `view_index` itself found removed; empty if nothing.
  [[nodiscard]] const PointCloud& removed_at(int view_index) const;
  /// Forgets what no view from `first_kept_view` on can still need.
  void forget_before(int first_kept_view);

 private:
  struct Entry {
    int view_index;
    PointCloud removed_in_world;
  };
  std::vector<Entry> entries_;
};

}  // namespace resight
