// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <span>
#include <vector>

#include "resight/changes/spherical_occlusion.hpp"
#include "resight/core/options.hpp"
#include "resight/geometry/point_cloud.hpp"
#include "resight/sensor/prepared_view.hpp"

namespace resight {

struct DetectChangesOptions {
  double tolerance_m = 0.02;
  double tolerance_sigmas = 0;
  double voxel_m = 0.005;
  OcclusionTest occlusion_test = OcclusionTest::kDepthImage;
  double bin_size_rad = 0.0349066;
  bool require_return = true;
  double occlusion_margin_m = 0.0;
  double occlusion_sigmas = 3.0;
  int window_radius_px = 1;
  bool novel_needs_free_space = true;
  double min_depth_m = 0.5;
  double max_depth_m = 3.5;
  double frustum_margin_rad = 0.0872665;
  double max_changed_share = 0.5;
  int num_threads = 1;  ///< Same bits for any value >= 1.
  void check() const { check_options("DetectChangesOptions", *this); }
};

inline void declare(OptionVisitor& v, DetectChangesOptions& o) {
  v.field("tolerance_m", o.tolerance_m, positive(),
          "epsilon: a point is explained by a point of the other cloud within this distance.", "paper, Eq. (2); V4R");
  v.field("tolerance_sigmas", o.tolerance_sigmas, between(0, 10),
          "Widens it to this many standard deviations of two depth measurements. 0: the paper's fixed tolerance.");
  v.field("voxel_m", o.voxel_m, positive(), "Both clouds are downsampled to this.", "V4R");
  v.choice(
      "occlusion_test", o.occlusion_test,
      {{"spherical_bins", "z-buffer of spherical bins (paper, Eq. (4))"}, {"depth_image", "the depth image itself"}},
      "How points that the view cannot see are told from points that are gone.");
  v.only_if(o.occlusion_test == OcclusionTest::kSphericalBins, "occlusion_test", "spherical_bins", [&] {
    v.field("bin_size_rad", o.bin_size_rad, between(0.001, std::numbers::pi / 2), "Size of a bin (2 deg).", "paper");
    v.field("require_return", o.require_return,
            "A point is seen through only if the depth image has a return within window_radius_px of it.", "ours");
  });
  v.field("occlusion_margin_m", o.occlusion_margin_m, at_least(0),
          "Points behind a surface by more than this are hidden.", "paper: 0");
  v.field("occlusion_sigmas", o.occlusion_sigmas, at_least(0),
          "Noise in that margin of tests in the depth image, in standard deviations.", "Nguyen et al. 2012");
  v.field("window_radius_px", o.window_radius_px, between(0, 100),
          "Tests in the depth image take the nearest return within this many rows and columns. 0: that of the pixel.");
  v.field("novel_needs_free_space", o.novel_needs_free_space,
          "Points are novel only where an earlier view saw free space. Off: wherever nothing was, Eq. (3) alone.",
          "ours");
  v.field("min_depth_m", o.min_depth_m, at_least(0), "Near end of the view volume.", "V4R");
  v.field("max_depth_m", o.max_depth_m, positive(), "Far end of the view volume.", "V4R");
  v.field("frustum_margin_rad", o.frustum_margin_rad, between(0, std::numbers::pi / 2),
          "Taken off each side of the view volume (5 deg).", "V4R");
  v.field(
      "max_changed_share", o.max_changed_share, between(0, 1),
      "If a larger share of the visible surface changed, the camera pose is suspect and nothing is removed. 1: never.");
  v.num_threads(o.num_threads);
  v.rule(std::isfinite(o.max_depth_m) && o.max_depth_m > o.min_depth_m, "max_depth_m must be finite and > min_depth_m");
}

/// Changes of one view against the reconstruction before it.
struct ChangeResult {
  PointCloud novel_in_world;            ///< N of Eq. (3), where Psi could have had a point. With colours.
  PointCloud removed_in_world;          ///< D of Alg. 1, line 3. With what attributes Psi has.
  Image<std::uint8_t> novel_mask;       ///< Non-zero at the novel pixels of the view.
  std::array<int, 4> evidence_count{};  ///< Of the (thinned) points of Psi, by Evidence.
  double changed_share = 0;             ///< Removed / (removed + present) points of Psi.
  double novel_share = 0;               ///< Novel / (novel + explained by Psi) pixels of the view.
  bool pose_suspect = false;            ///< See max_changed_share; novel and removed are then empty.
};

/// Alg. 1, lines 1 to 3 and Eq. (3): `previous_in_world` is Psi_{k-1} (empty: the first view, no changes).
///
/// Removed: points of Psi that have no point of the view within the tolerance, lie in the view volume and are seen
/// through. With the spherical bins, a bin of 2 deg (18 px of a Kinect) may hold returns while the pixels of the point
/// have none: `require_return` then keeps the point, for a missing return is no evidence of free space.
///
/// Novel: pixels of the view that have no point of Psi within the tolerance. Eq. (3) stops here, and so do we without
/// `earlier_views` or without novel_needs_free_space: surfaces that no one could see before then count as novel. With
/// both (the views that Psi was made of; null entries are not allowed), a point must also be seen through by at least
/// one of them, in its view volume and by its depth image: the same evidence that a removal needs, mirrored. What lay
/// outside or behind is newly seen, not new.
///
/// `previous_voxel_m`: Psi is known to have at most one point per cube of this side; 0: not known.
///
/// Psi is thinned before the comparison and N after it: the side that explains stays as dense as it is, because a
/// thinned one is up to a voxel farther from a point and would leave more of the other over.
///
/// With a wrong camera pose most of the scene seems to have changed: if changed_share exceeds max_changed_share, or
/// novel_share does where earlier views vouch for it, no change is reported at all.
[[nodiscard]] ChangeResult detect_changes(const PointCloud& previous_in_world, const PreparedView& view,
                                          const DetectChangesOptions& options = {},
                                          std::span<const PreparedView* const> earlier_views = {},
                                          double previous_voxel_m = 0);

}  // namespace resight
