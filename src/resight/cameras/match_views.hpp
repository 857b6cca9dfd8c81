// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <optional>
#include <vector>

#include "resight/features/view_features.hpp"
#include "resight/registration/pose_estimation.hpp"

namespace resight {

struct MatchViewsOptions {
  double max_ratio = 0.85;  ///< Of the distances to the best and the second best descriptor (Lowe 2004).
  EstimatePoseOptions pose{.inlier_distance_m = 0.03, .max_normal_angle_rad = 0.8, .min_inliers = 6};
  void check() const;
};

/// Relative pose of two cameras and the matches that support it.
struct ViewMatch {
  Rigid3 a_from_b;
  int num_inliers = 0;
  double rms_m = 0;                                 ///< Root mean square distance of the inliers.
  std::vector<Eigen::Vector3f> points_a, points_b;  ///< Of the inliers, each in its camera frame.
};

/// Relative pose of two cameras with overlapping views, from mutual feature matches and RANSAC; needs no initial
/// estimate. None if too few matches agree. A large rigid object that moved between the views may win over the
/// background, so callers verify the pose with the whole views (evaluate_alignment()).
[[nodiscard]] std::optional<ViewMatch> match_views(const ViewFeatures& a, const ViewFeatures& b,
                                                   const MatchViewsOptions& options = {});

}  // namespace resight
