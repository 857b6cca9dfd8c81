// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <variant>

#include "resight/changes/depth_changes.hpp"
#include "resight/changes/point_changes.hpp"
#include "resight/core/options.hpp"
#include "resight/geometry/point_cloud.hpp"
#include "resight/sensor/prepared_view.hpp"

namespace resight {

struct DetectChangesOptions {
  std::variant<PointTestOptions, DepthTestOptions> test{};
  double voxel_m = 0.005;
  double max_changed_share = 0.5;
  int num_threads = 1;  ///< Same bits for any value >= 1.
  void check() const { check_options("DetectChangesOptions", *this); }
};

inline void declare(OptionVisitor& v, DetectChangesOptions& o) {
  v.choice("test", o.test,
           {{"points", "points of the view against points of the reconstruction (paper, Eq. (2) to (5))"},
            {"depth", "depth of the view against depth of the earlier views, within the noise of both"}},
           "How changed surface is found.");
  v.field("voxel_m", o.voxel_m, positive(), "Clouds of changed points are downsampled to this.", "V4R");
  v.field("max_changed_share", o.max_changed_share, between(0, 1),
          "If a larger share of the visible surface changed, the camera pose is suspect: nothing is removed, and the "
          "view is not used further unless the next one agrees with it. 1: never.");
  v.num_threads(o.num_threads);
}

/// Changes of one view against what was there before it.
struct ChangeResult {
  PointCloud novel_in_world;            ///< N of Eq. (3), where Psi could have had a point. With colours.
  PointCloud removed_in_world;          ///< D of Alg. 1, line 3. With what attributes Psi has.
  Image<std::uint8_t> novel_mask;       ///< Non-zero at the novel pixels of the view.
  Image<std::uint8_t> removed_mask;     ///< Non-zero at pixels of the view that see through removed surface.
  std::array<int, 4> evidence_count{};  ///< Of the surface known before, in points or pixels, by Evidence.
  double changed_share = 0;             ///< Removed / (removed + present) of the surface known before.
  double novel_share = 0;               ///< Novel / (novel + explained) pixels of the view.
  bool pose_suspect = false;            ///< See max_changed_share; novel and removed are then empty.
};

/// Alg. 1, lines 1 to 3 and Eq. (3): finds what was removed from the scene and what is novel in it.
/// `previous_in_world` is Psi_{k-1}, the reconstruction (empty: the first view, no changes), `earlier_views` the views
/// that it was made of, cleared of what was removed before; null entries are not allowed. `previous_voxel_m`: Psi is
/// known to have at most one point per cube of this side; 0: not known.
///
/// Test "points": find_point_changes(). Test "depth": find_depth_changes(), which needs the earlier views only.
///
/// With a wrong camera pose most of the scene seems to have changed: if changed_share exceeds max_changed_share, or
/// novel_share does where earlier views vouch for it, no change is reported at all.
[[nodiscard]] ChangeResult detect_changes(const PointCloud& previous_in_world, const PreparedView& view,
                                          const DetectChangesOptions& options = {},
                                          std::span<const PreparedView* const> earlier_views = {},
                                          double previous_voxel_m = 0);

}  // namespace resight
