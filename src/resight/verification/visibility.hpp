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
  const Image<Rgb8>* color = nullptr;  ///< Of the view, which must outlive this; null if it has none.
  Image<float> depth_m;                ///< Of the view's cloud; small holes filled (fill_small_holes()).
};

[[nodiscard]] std::vector<DepthView> prepare_depth_views(std::span<const VerificationView> views, int num_threads);

/// Points are not visible if they are seen at a more grazing angle: cosine between normal and viewing ray (84 deg).
inline constexpr double kMinFacing = 0.1;

/// How densely points sample a model.
struct ModelSampling {
  double spacing_m = 0.005;
  int min_points = 20;  ///< Fewer that are seen are no evidence that it is there, or not.
};

struct ModelVisibility {
  /// Per view (empty where not allowed, and of before it came) and model point. Points that the model itself hides are
  /// kOccluded.
  std::vector<std::vector<Evidence>> evidence;
  std::vector<int> visible;  ///< Points observed (is_observed()) in at least one view, ascending.
  std::vector<float>
      facing;  ///< Per entry of `visible`: largest cosine between normal and viewing ray among those views.
  std::vector<std::uint8_t> seen_through;  ///< Per entry of `visible`: the newest of those views looks through it, or
                                           ///< more than MajorityFreeSpace::max_share do.
};

/// Visibility of model points at their pose in the world (normals empty: no point counts as turned away). Views from
/// the oldest to the newest; `allowed`: one per view. A view that looks through more than
/// VisibilityOptions::arrival_share of what it could see, while newer ones see the model where it is, is of before it
/// came: it and older ones do not count. V4R's GO3D without its gaps: intrinsics of the view instead of f = 525, and
/// the model hides its own far parts (back faces by their normals, the rest by a z-buffer of the model, whose cells are
/// as wide as the spacing of its points).
[[nodiscard]] ModelVisibility find_visible_points(std::span<const Eigen::Vector3f> points_in_world,
                                                  std::span<const Eigen::Vector3f> normals_in_world,
                                                  std::span<const DepthView> views,
                                                  std::span<const std::uint8_t> allowed,
                                                  const VisibilityOptions& options, const ModelSampling& sampling);

}  // namespace resight
