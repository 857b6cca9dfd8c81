// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "resight/changes/spherical_occlusion.hpp"
#include "resight/geometry/point_cloud.hpp"
#include "resight/sensor/prepared_view.hpp"

namespace resight {

struct DetectChangesOptions {
  double tolerance_m = 0.02;    ///< epsilon of Eq. (2); V4R: 2 cm as called.
  double tolerance_sigmas = 0;  ///< Widens epsilon to so many sigmas of two measurements at that depth; 0: paper.
  double voxel_m = 0.005;       ///< Both clouds are thinned to this (V4R: 5 mm).
  double previous_voxel_m = 0;  ///< Psi is known to have one point at most in a cube of this side; 0: not known.
  OcclusionTest occlusion_test = OcclusionTest::kDepthImage;  ///< Paper: kSphericalBins.
  double bin_size_rad = 0.0349066;                            ///< Of the spherical z-buffer; paper: 2 deg.
  double occlusion_margin_m = 0.0;  ///< A blocker hides what is farther by more than this. Paper: 0.
  double occlusion_sigmas = 3.0;    ///< kDepthImage only: the noise's share of that margin (DepthMargin).
  int window_radius_px = 1;         ///< Of the look-up in the depth image: SurfaceEvidenceOptions.
  bool require_return = true;       ///< kSphericalBins only: see detect_changes().
  bool novel_needs_free_space =
      true;                  ///< Novel points must be seen through by an earlier view. Paper: false, Eq. (3) alone.
  double min_depth_m = 0.5;  ///< View volume (V4R: Xtion, 0.5 to 3.5 m).
  double max_depth_m = 3.5;
  double frustum_margin_rad = 0.0872665;  ///< Off each side of the view volume (V4R: 5 deg).
  double max_changed_share = 0.5;  ///< More of the visible surface changed: the camera pose is suspect, and nothing is
                                   ///< removed.
  int num_threads = 1;             ///< Same bits for any value >= 1.
  void check() const;
};

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
/// Psi is thinned before the comparison and N after it: the side that explains stays as dense as it is, because a
/// thinned one is up to a voxel farther from a point and would leave more of the other over.
///
/// With a wrong camera pose most of the scene seems to have changed: if changed_share exceeds max_changed_share, or
/// novel_share does where earlier views vouch for it, no change is reported at all.
[[nodiscard]] ChangeResult detect_changes(const PointCloud& previous_in_world, const PreparedView& view,
                                          const DetectChangesOptions& options = {},
                                          std::span<const PreparedView* const> earlier_views = {});

}  // namespace resight
