// SPDX-License-Identifier: Apache-2.0
#include "resight/registration/pose_uncertainty.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>

namespace resight {
namespace {

// Directions with less information than this share of the pairs are free.
constexpr double kFreeShare = 0.01;

// Converts a twist about the middle of the points to one about the object's centre.
Matrix6 about_center(const Eigen::Vector3d& d) {
  Matrix6 change = Matrix6::Identity();
  change.bottomLeftCorner<3, 3>() << 0, d.z(), -d.y(), -d.z(), 0, d.x(), d.y(), -d.x(), 0;  // rotation x d
  return change;
}

}  // namespace

PoseUncertainty pose_uncertainty(const StepEquations& equations, double radius_m,
                                 const Eigen::Vector3d& middle_to_center, double min_sigma_m, double free_sigma_m,
                                 double pairs_per_independent_one) {
  constexpr int kUnknowns = 6;
  PoseUncertainty result;
  if (equations.num_pairs <= kUnknowns || !(equations.sum_weights > 0)) return result;
  // Makes the result independent of the scale of the weights.
  const double per_pair = equations.sum_weights / equations.num_pairs;
  const double freedom = static_cast<double>(equations.num_pairs) / (equations.num_pairs - kUnknowns);
  const double variance =
      std::max(min_sigma_m * min_sigma_m, freedom * equations.sum_residuals_sq / equations.sum_weights);
  const Eigen::SelfAdjointEigenSolver<Matrix6> solver(equations.matrix / per_pair);
  // Converts rotations from metres back to radians.
  Matrix6 scale = Matrix6::Identity();
  scale.topLeftCorner<3, 3>() /= radius_m;
  const Matrix6 change = about_center(middle_to_center);
  Matrix6 about_middle = Matrix6::Zero();
  for (int i = 0; i < kUnknowns; ++i) {
    const double information = solver.eigenvalues()[i];
    const Vector6 direction = scale * solver.eigenvectors().col(i);
    const bool is_free = information < kFreeShare * equations.num_pairs;
    about_middle += direction * direction.transpose() *
                    (is_free ? free_sigma_m * free_sigma_m : pairs_per_independent_one * variance / information);
    if (!is_free) continue;
    Vector6 free = change * direction;
    free.head<3>() *= radius_m;
    result.free_directions.push_back(free.normalized());
  }
  result.covariance = change * about_middle * change.transpose();
  return result;
}

}  // namespace resight
