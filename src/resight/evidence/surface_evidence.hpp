// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "resight/core/image.hpp"
#include "resight/geometry/camera.hpp"

namespace resight {

/// What a view says about a point of the past. Absence needs evidence: only kSeenThrough may remove a point.
enum class Evidence : std::uint8_t { kUnobserved, kOccluded, kPresent, kSeenThrough };

struct DepthEvidenceOptions {
  int window_radius_px = 1;   ///< The nearest return within this many rows and columns of the projection counts.
  double margin_m = 0.0;      ///< Along z, added to that of the noise.
  double noise_sigmas = 3.0;  ///< Margin in axial standard deviations of a surface seen head-on (nguyen_noise()).
  int num_threads = 1;        ///< Same bits for any value >= 1.
  void check() const;
};

/// The test against the depth image itself. For each query (camera frame), with d the smallest depth in the window
/// around its projection: kOccluded if d lies in front of it by more than the margin, kSeenThrough if behind, kPresent
/// if within; kUnobserved where the window has no return or lies outside the image, for z <= 0 and for NaN. Ours, in
/// place of the spherical bins: a window of 3 px is six times finer than a bin, so that slanted surfaces do not hide
/// themselves, and it holds no more than the view itself knows. Taking the nearest keeps the points beside an edge.
[[nodiscard]] std::vector<Evidence> classify_against_depth(std::span<const Eigen::Vector3f> queries_in_camera,
                                                           const Camera& camera, const Image<float>& depth_m,
                                                           const DepthEvidenceOptions& options = {});

/// Smallest depth within `radius_px` rows and columns of the pixel that a point projects to; NaN if there is no return,
/// the pixel lies outside the image, or for z <= 0 and NaN.
[[nodiscard]] float nearest_depth(const Eigen::Vector3f& p_in_camera, const Camera& camera, const Image<float>& depth_m,
                                  int radius_px);

}  // namespace resight
