// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <numbers>
#include <optional>
#include <span>
#include <vector>

#include "resight/core/options.hpp"
#include "resight/registration/correspondence.hpp"

namespace resight {

/// Weighted least-squares rigid motion scene_from_model (Umeyama 1991 without scale). Empty `weights` = all 1. Pairs
/// with a NaN coordinate or zero weight are ignored. None for fewer than three pairs or for collinear points. Throws
/// std::invalid_argument if the spans differ in length or a weight is negative or NaN.
[[nodiscard]] std::optional<Rigid3> fit_rigid(std::span<const Eigen::Vector3f> model,
                                              std::span<const Eigen::Vector3f> scene,
                                              std::span<const double> weights = {});

struct EstimatePoseOptions {
  double inlier_distance_m = 0.015;
  double max_normal_angle_rad = 0.6435;
  int max_iterations = 500;
  int min_inliers = 5;
  std::uint64_t seed = 1;
  void check() const { check_options("EstimatePoseOptions", *this); }
};

inline void declare(OptionVisitor& v, EstimatePoseOptions& o) {
  v.field("inlier_distance_m", o.inlier_distance_m, positive(),
          "Correspondences within this distance agree with a pose.", "V4R");
  v.field("max_normal_angle_rad", o.max_normal_angle_rad, between(0, std::numbers::pi),
          "Largest angle between the normals of an inlier.", "V4R (cosine of 0.8)");
  v.field("max_iterations", o.max_iterations, at_least(1),
          "Iterations of RANSAC; fewer if the share of inliers allows.");
  v.field("min_inliers", o.min_inliers, at_least(3), "Poses with fewer inliers are rejected.");
  v.seed(o.seed);
}

/// A pose and the correspondences that agree with it.
struct PoseEstimate {
  Rigid3 scene_from_model;
  std::vector<int> inliers;  ///< Ascending indices of the correspondences.
  double rms_m = 0;          ///< Root mean square distance of the inliers.
};

/// Estimates a pose with RANSAC over three correspondences, then refines it (refine_pose). None if fewer than
/// min_inliers correspondences agree, or if the inliers are collinear.
///
/// An inlier lies within inlier_distance_m of its model point, and the angle between its normals is at most
/// max_normal_angle_rad; a NaN normal passes this test. A NaN point is never an inlier. max_iterations counts scored
/// poses. Samples whose triangles differ are rejected before scoring at almost no cost, so many more samples may be
/// drawn.
[[nodiscard]] std::optional<PoseEstimate> estimate_pose(std::span<const Correspondence> correspondences,
                                                        const EstimatePoseOptions& options = {});

/// Refines a given pose: least squares over its inliers with weights 1 - d^2 / inlier_distance_m^2, repeated until
/// neither inliers nor pose change. None if fewer than min_inliers remain or the inliers become collinear.
[[nodiscard]] std::optional<PoseEstimate> refine_pose(std::span<const Correspondence> correspondences,
                                                      const Rigid3& scene_from_model,
                                                      const EstimatePoseOptions& options = {});

/// Squared distance (m^2) of each correspondence under the pose; infinite for outliers (see estimate_pose).
[[nodiscard]] std::vector<float> inlier_residuals_sq(std::span<const Correspondence> correspondences,
                                                     const Rigid3& scene_from_model,
                                                     const EstimatePoseOptions& options = {});

}  // namespace resight
