// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <limits>
#include <vector>

#include "resight/registration/point_to_plane.hpp"

namespace resight {

/// First-order uncertainty of an estimated pose.
struct PoseUncertainty {
  /// Covariance of a small rotation about the object's centre (rotation vector, rad) followed by a translation (m),
  /// along the world axes: the true pose is the estimate moved by both. NaN = unknown (too few pairs).
  Matrix6 covariance = Matrix6::Constant(std::numeric_limits<double>::quiet_NaN());
  /// Directions that the data do not constrain, such as the rotation of an untextured can about its axis: unit vectors
  /// [rotation * radius; translation]. Along them, the covariance holds the search range instead of a measurement.
  std::vector<Vector6> free_directions;

  [[nodiscard]] bool is_known() const { return covariance.allFinite(); }
};

/// Derives the uncertainty from the equations of the last ICP step. `middle_to_center` leads from the middle of the
/// points to the object's centre (world axes). The noise is that of the residuals, but at least `min_sigma_m`. A
/// direction is free if its information is less than 1 % of that of a translation along the normals of all points; its
/// standard deviation is then `free_sigma_m`. If errors are correlated, `pairs_per_independent_one` pairs count as one.
/// Sensor bias is not included.
[[nodiscard]] PoseUncertainty pose_uncertainty(const StepEquations& equations, double radius_m,
                                               const Eigen::Vector3d& middle_to_center, double min_sigma_m,
                                               double free_sigma_m, double pairs_per_independent_one = 1);

}  // namespace resight
