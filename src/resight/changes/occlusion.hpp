// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "resight/geometry/spherical_bins.hpp"
#include "resight/sensor/prepared_view.hpp"

namespace resight {

/// What a view says about a point of the past. Absence needs evidence: only kSeenThrough may remove a point.
enum class Evidence : std::uint8_t { kUnobserved, kOccluded, kPresent, kSeenThrough };

/// The two ways to tell whether a view sees past a point.
enum class OcclusionTest : std::uint8_t {
  kSphericalBins,  ///< The paper's, Eq. (4) and Fig. 4: classify_occlusion().
  kDepthImage,     ///< Ours: project into the depth image, classify_against_depth().
};

/// The paper's spherical z-buffer. Queries and blockers: metres, camera frame, NaN = no measurement. For each query:
/// kOccluded if the nearest blocker of its bin is nearer by more than `margin_m` (ranges, not depths); kSeenThrough if
/// the bin has blockers, but none so near; kUnobserved if the bin is empty, or for NaN: no return is no evidence.
/// kPresent does not occur. Sec. III-B1. Deviations: the text asks for every blocker of the bin to be nearer, Fig. 4
/// for the nearest one: we follow the figure, which rather keeps a point. Nor does an empty bin count as free space. On
/// a surface seen at a slant, the nearest point of a bin of 2 deg hides most of the rest: such changes are missed, as
/// they are in the paper.
[[nodiscard]] std::vector<Evidence> classify_occlusion(std::span<const Eigen::Vector3f> queries_in_camera,
                                                       std::span<const Eigen::Vector3f> blockers_in_camera,
                                                       const SphericalBins& bins, double margin_m, int num_threads = 1);

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
