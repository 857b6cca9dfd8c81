// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>
#include <span>
#include <vector>

#include "resight/registration/correspondence.hpp"

namespace resight {

/// Least-squares rigid motion scene_from_model with weights (Umeyama 1991 without scale; empty weights = all 1). Pairs
/// with a NaN coordinate or a weight of zero do not count. None for fewer than three pairs or when they lie on a line.
[[nodiscard]] std::optional<Rigid3> fit_rigid(std::span<const Eigen::Vector3f> model,
                                              std::span<const Eigen::Vector3f> scene,
                                              std::span<const double> weights = {});

struct EstimatePoseOptions {
  double inlier_distance_m = 0.015;      ///< V4R: 1.5 cm.
  double max_normal_angle_rad = 0.6435;  ///< V4R accepts at cos >= 0.8.
  int max_iterations = 500;              ///< Of the RANSAC; fewer when the inlier share allows.
  int min_inliers = 5;
  std::uint64_t seed = 1;
  void check() const;
};

struct PoseEstimate {
  Rigid3 scene_from_model;
  std::vector<int> inliers;  ///< Ascending indices of the correspondences.
  double rms_m = 0;          ///< Of the inliers.
};

/// RANSAC over three correspondences, then least squares over the inliers, robustly re-weighted until they stand
/// (refine_pose). None when fewer than min_inliers agree, or when those that agree lie on a line.
///
/// An inlier lies within inlier_distance_m, and its normals (if both are finite: NaN = no measurement) within
/// max_normal_angle_rad. A NaN point is never an inlier. max_iterations counts the poses that are scored; samples whose
/// triangles differ are thrown away before and cost next to nothing, so that many more may be drawn.
[[nodiscard]] std::optional<PoseEstimate> estimate_pose(std::span<const Correspondence> correspondences,
                                                        const EstimatePoseOptions& options = {});

/// The second half of estimate_pose from a given start: least squares with Tukey's weights over the inliers of the
/// pose, repeated until neither the inliers nor the pose change. None when it falls below min_inliers or onto a line.
[[nodiscard]] std::optional<PoseEstimate> refine_pose(std::span<const Correspondence> correspondences,
                                                      const Rigid3& scene_from_model,
                                                      const EstimatePoseOptions& options = {});

/// Squared distance of each correspondence under the pose, m^2; infinite where it is no inlier (see estimate_pose).
[[nodiscard]] std::vector<float> inlier_residuals_sq(std::span<const Correspondence> correspondences,
                                                     const Rigid3& scene_from_model,
                                                     const EstimatePoseOptions& options = {});

}  // namespace resight
