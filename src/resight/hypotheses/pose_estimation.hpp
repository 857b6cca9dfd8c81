// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>
#include <span>
#include <vector>

#include "resight/hypotheses/hypothesis.hpp"

namespace resight {

/// Least-squares rigid motion scene_from_model with weights (Umeyama 1991 without scale; empty weights = all 1). None for fewer
/// than three pairs or when they lie on a line.
[[nodiscard]] std::optional<Rigid3> fit_rigid(std::span<const Eigen::Vector3f> model, std::span<const Eigen::Vector3f> scene, std::span<const double> weights = {});

struct EstimatePoseOptions {
  double inlier_distance_m = 0.015;  ///< V4R: 1.5 cm.
  double max_normal_angle_rad = 0.6435;  ///< V4R accepts at cos >= 0.8.
  int max_iterations = 500;          ///< Of the RANSAC; fewer when the inlier share allows.
  int min_inliers = 5;
  std::uint64_t seed = 1;
  void check() const;
};

struct PoseEstimate {
  Rigid3 scene_from_model;
  std::vector<int> inliers;   ///< Ascending indices of the correspondences.
  double rms_m = 0;           ///< Of the inliers.
};

/// RANSAC over three correspondences, then least squares over the inliers, robustly re-weighted until they stand. None when
/// fewer than min_inliers agree.
[[nodiscard]] std::optional<PoseEstimate> estimate_pose(std::span<const Correspondence> correspondences, const EstimatePoseOptions& options = {});

}  // namespace resight
