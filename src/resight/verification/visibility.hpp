// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "resight/evidence/surface_evidence.hpp"
#include "resight/verification/hypothesis_evidence.hpp"
#include "resight/verification/visibility_options.hpp"

namespace resight {

/// What the visibility test needs of a view.
struct DepthView {
  Camera camera;
  Rigid3 world_from_camera;
  const Image<Rgb8>* color = nullptr;  ///< Of the view, which must outlive this.
  /// Depth of the view; small holes are filled (fill_small_holes()), NaN near depth edges.
  Image<float> depth_m;
};

/// `min_edge_distance_px`: see VisibilityOptions.
[[nodiscard]] std::vector<DepthView> prepare_depth_views(std::span<const VerificationView> views,
                                                         double min_edge_distance_px, int num_threads);

/// Points are not visible if they are seen at a more grazing angle: cosine between normal and viewing ray (84 deg).
inline constexpr double kMinFacing = 0.1;

struct ModelVisibility {
  /// Per view and model point; empty for views that are not allowed. Self-occluded points are kOccluded.
  std::vector<std::vector<Evidence>> evidence;
  std::vector<int> visible;  ///< Points observed (is_observed()) in at least one view, ascending.
  /// Per entry of `visible`: largest cosine between normal and viewing ray among those views.
  std::vector<float> facing;
  /// Per entry of `visible`: whether the newest observing view, or more than MajorityFreeSpace::max_share of them, sees
  /// through the point.
  std::vector<std::uint8_t> seen_through;
};

/// Visibility of model points at their pose in the world. Views are ordered from oldest to newest; `allowed` has one
/// entry per view. Without normals, no point faces away. Unlike V4R's GO3D, uses the intrinsics of the view and
/// handles self-occlusion: back faces by their normals, the rest by a z-buffer. `spacing_m`: of the model points, and
/// the width of the cells of that z-buffer.
[[nodiscard]] ModelVisibility find_visible_points(std::span<const Eigen::Vector3f> points_in_world,
                                                  std::span<const Eigen::Vector3f> normals_in_world,
                                                  std::span<const DepthView> views,
                                                  std::span<const std::uint8_t> allowed,
                                                  const VisibilityOptions& options, double spacing_m);

}  // namespace resight
