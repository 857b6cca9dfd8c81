// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <functional>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "resight/inspection/view_pairs.hpp"

namespace resight {

/// A number that several pairs of views tell, with its standard error over the pairs (jackknife).
struct Estimate {
  double value = 0;
  double standard_error = 0;
};

/// What a camera's intrinsics should be changed by, from views alone: their motions are rigid only under the right
/// ones.
struct IntrinsicsFit {
  Estimate log_focal;  ///< Natural logarithm of the right focal length over the given one.
  Estimate center_x_px;
  Estimate center_y_px;
};
inline constexpr std::size_t kMinFitPairs = 4;
/// None with fewer than kMinFitPairs pairs.
[[nodiscard]] std::optional<IntrinsicsFit> fit_intrinsics(std::span<const ViewPair> pairs, const Camera& camera);

/// The poses of a sequence under one reading of them, and how well it explains what the views show. Pairs that show a
/// change say nothing.
struct GivenPosesFit {
  /// Median over the pairs of the median distance of their matches; infinite if the poses reach no pair.
  double error_px = std::numeric_limits<double>::infinity();
  /// Natural logarithm of depth over poses: translations must be multiplied by the scale. None if no pair moves.
  std::optional<Estimate> log_scale;
  std::vector<double> pair_errors_px;
};
/// Relative motion b_from_a of a pair as poses give it; none if they do not reach there.
using GivenMotion = std::function<std::optional<Rigid3>(const ViewPair&)>;
/// Errors at the scale as given.
[[nodiscard]] GivenPosesFit evaluate_poses(std::span<const ViewPair> pairs, const Camera& camera,
                                           const GivenMotion& motion);
/// Also finds the scale of the translations, and the errors with it.
[[nodiscard]] GivenPosesFit fit_pose_scale(std::span<const ViewPair> pairs, const Camera& camera,
                                           const GivenMotion& motion);

}  // namespace resight
