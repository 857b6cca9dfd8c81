// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cmath>
#include <numbers>
#include <span>
#include <vector>

#include "resight/core/options.hpp"
#include "resight/geometry/point_cloud.hpp"
#include "resight/sensor/prepared_view.hpp"

namespace resight {

/// The paper's test of changes: points against points.
struct PointTestOptions {
  double tolerance_m = 0.02;
  double bin_size_rad = 0.0349066;
  bool require_return = true;
  double occlusion_margin_m = 0.0;
  double occlusion_sigmas = 3.0;
  int window_radius_px = 1;
  bool novel_needs_free_space = true;
  double min_depth_m = 0.5;
  double max_depth_m = 3.5;
  double frustum_margin_rad = 0.0872665;
};

inline void declare(OptionVisitor& v, PointTestOptions& o) {
  v.field("tolerance_m", o.tolerance_m, positive(),
          "epsilon: a point is explained by a point of the other cloud within this distance.", "paper, Eq. (2); V4R");
  v.field("bin_size_rad", o.bin_size_rad, between(0.001, std::numbers::pi / 2),
          "Size of a bin of the spherical z-buffer (2 deg).", "paper, Eq. (4)");
  v.field("require_return", o.require_return,
          "A point is seen through only if the depth image has a return within window_radius_px of it.", "ours");
  v.field("occlusion_margin_m", o.occlusion_margin_m, at_least(0),
          "Points behind a surface by more than this are occluded.", "paper: 0");
  v.field("occlusion_sigmas", o.occlusion_sigmas, at_least(0),
          "Depth noise added to this margin where novel points are compared with earlier depth images, in standard "
          "deviations.",
          "Nguyen et al. 2012");
  v.field("window_radius_px", o.window_radius_px, between(0, 100),
          "In depth images, the nearest return within this many rows and columns counts.");
  v.field("novel_needs_free_space", o.novel_needs_free_space,
          "Points are novel only where an earlier view saw free space. Off: wherever nothing was, Eq. (3) alone.",
          "ours");
  v.field("min_depth_m", o.min_depth_m, at_least(0), "Near end of the view volume.", "V4R");
  v.field("max_depth_m", o.max_depth_m, positive(), "Far end of the view volume.", "V4R");
  v.field("frustum_margin_rad", o.frustum_margin_rad, between(0, std::numbers::pi / 2),
          "Taken off each side of the view volume (5 deg).", "V4R");
  v.rule(std::isfinite(o.max_depth_m) && o.max_depth_m > o.min_depth_m, "max_depth_m must be finite and > min_depth_m");
}

/// Points that changed between a reconstruction and a view.
struct PointChanges {
  std::vector<int> novel;               ///< Pixels of the view, ascending.
  std::vector<int> removed;             ///< Points of the reconstruction, ascending.
  std::array<int, 4> evidence_count{};  ///< Of the points of the reconstruction, by Evidence.
  std::size_t num_explained = 0;        ///< Pixels of the view that a point of the reconstruction explains.
};

/// The reconstruction before a view, Psi_{k-1}; both must outlive their use.
struct PreviousScene {
  const PointCloud& in_world;         ///< All points.
  const PointCloud& sparse_in_world;  ///< One point per voxel; may be the same.
};

/// Removed: points of (sparse) Psi that have no point of the view within the tolerance, lie in the view volume and are
/// seen through by the z-buffer of spherical bins. A bin of 2 deg (18 px of a Kinect) may hold returns while the pixels
/// of the point have none: `require_return` then keeps the point, because a missing return is no evidence of free
/// space.
///
/// Novel: pixels of the view without a point of Psi within the tolerance; this is all of Eq. (3). With `earlier_views`
/// and novel_needs_free_space, at least one earlier view must also have seen through the point, within its view volume
/// and by its depth image. Surface that was occluded or outside the image is newly seen, not novel.
///
/// Psi is downsampled before the comparison. The explaining side stays dense, because downsampling moves points by up
/// to a voxel.
[[nodiscard]] PointChanges find_point_changes(const PreviousScene& previous, const PreparedView& view,
                                              std::span<const PreparedView* const> earlier_views,
                                              const PointTestOptions& options, int num_threads);

}  // namespace resight
