// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <limits>
#include <vector>

#include "resight/registration/point_to_plane.hpp"

namespace resight {

/// How well the data fix a pose, to first order.
struct PoseUncertainty {
  using Vector6 = Eigen::Matrix<double, 6, 1>;
  using Matrix6 = Eigen::Matrix<double, 6, 6>;

  /// Of a small turn about the object's centre (rotation vector, rad) and a shift (m), in this order and along the axes
  /// of the world: the true pose is exp(turn) and shift away. NaN = not known: too few pairs.
  Matrix6 covariance = Matrix6::Constant(std::numeric_limits<double>::quiet_NaN());
  /// Directions that the data leave free, such as the turn of a plain can about its axis: [turn * radius; shift], unit
  /// vectors. Along them the covariance holds what the search allows, no measurement.
  std::vector<Vector6> free_directions;

  [[nodiscard]] bool is_known() const { return covariance.allFinite(); }
};

/// From the equations of the last step of ICP, about `middle_to_center` (from the middle of its points to the object's
/// centre, world axes). The noise is that of the residuals, but at least `min_sigma_m`; a direction is free if it has
/// less than a hundredth of what a shift along the normals of all points would have; there the standard deviation is
/// `free_sigma_m`. Of pairs whose errors are not independent, `pairs_per_independent_one` count as one. The bias of the
/// sensor is not in it.
[[nodiscard]] PoseUncertainty pose_uncertainty(const StepEquations& equations, double radius_m,
                                               const Eigen::Vector3d& middle_to_center, double min_sigma_m,
                                               double free_sigma_m, double pairs_per_independent_one = 1);

}  // namespace resight
