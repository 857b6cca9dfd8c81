// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <span>
#include <vector>

#include "resight/features/view_features.hpp"
#include "resight/geometry/camera.hpp"
#include "resight/geometry/rigid3.hpp"
#include "resight/sensor/rgbd_frame.hpp"

namespace resight {

/// A point of the scene that two views show. Depths are in any unit, the same for both.
struct MatchedPoint {
  Eigen::Vector2d pixel_a;
  Eigen::Vector2d pixel_b;
  double depth_a = 0;
  double depth_b = 0;
};

/// Two views with the motion between them, as their images and depths tell it, without the given poses.
struct ViewPair {
  int a = 0;
  int b = 0;
  std::vector<MatchedPoint> matches;  ///< Those that agree with the motion.
  std::vector<MatchedPoint> others;   ///< Those that do not: most of them are wrong.
  Rigid3 b_from_a;                    ///< Translation in the unit of the depths.
  double error_px = 0;                ///< Median distance of the matches in the image of b.
  bool shows_change = false;          ///< The matches are on what has moved: they say nothing about poses.
};

/// Units of the residuals of matches. A SIFT keypoint and the depth beside it are off by about a pixel together; no
/// depth camera errs by more than 2 % within its range.
inline constexpr double kMatchSigma_px = 1.5;
inline constexpr double kMatchDepthSigma = 0.02;

/// Features of a view whose depth was divided by `depth_unit_m`. The camera's depth unit does not matter.
[[nodiscard]] ViewFeatures extract_view_features(RgbdFrame frame, double depth_unit_m, int num_threads);

/// Finds the motion between two views from mutual matches (Lowe's ratio test) by RANSAC and least squares. A pair
/// without matches, if fewer than 15 agree.
[[nodiscard]] ViewPair match_view_pair(int a, const ViewFeatures& features_a, int b, const ViewFeatures& features_b,
                                       const Camera& camera);

/// Normalised residuals of matches under a motion: x and y in kMatchSigma_px, then depth in kMatchDepthSigma. A point
/// that the motion puts behind the camera gets 100 for each.
[[nodiscard]] std::vector<Eigen::Vector3d> match_residuals(std::span<const MatchedPoint> matches, const Camera& camera,
                                                           const Rigid3& b_from_a);

/// Least squares with Cauchy's weights, from a motion nearby.
[[nodiscard]] Rigid3 refine_motion(std::span<const MatchedPoint> matches, const Camera& camera, Rigid3 b_from_a);

/// Median distance of the matches in the image of b, px, at most 1000.
[[nodiscard]] double median_error_px(std::span<const MatchedPoint> matches, const Camera& camera,
                                     const Rigid3& b_from_a);

/// Of every fourth row and column, the pixels of a whose depth, moved by b_from_a, is that of b within 1 %. Depths in
/// the unit of the translation.
[[nodiscard]] int count_same_depth(const Image<float>& depth_a, const Image<float>& depth_b, const Camera& camera,
                                   const Rigid3& b_from_a);

}  // namespace resight
