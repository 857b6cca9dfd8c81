// SPDX-License-Identifier: Apache-2.0
#include "resight/inspection/motion_fit.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "resight/core/statistics.hpp"

namespace resight {
namespace {

constexpr int kFitSteps = 8;
constexpr double kStep = 1e-4;            // Of the numerical derivative.
constexpr double kMinTranslation = 0.01;  // Share of the distance of the scene; shorter ones tell no scale.
constexpr std::size_t kMinFitPairs = 4;

using Vector = Eigen::VectorXd;
using PairResiduals = std::function<Vector(std::size_t pair, const Vector& parameters)>;

struct ParameterFit {
  Vector values;
  Vector standard_errors;
};

/// Gauss-Newton steps over all pairs; weights are Cauchy's.
ParameterFit fit_parameters(std::size_t num_pairs, Vector values, const PairResiduals& residuals) {
  const Eigen::Index n = values.size();
  std::vector<Eigen::MatrixXd> normals(num_pairs);
  std::vector<Vector> rights(num_pairs);
  Eigen::MatrixXd normal;
  Vector right;
  for (int step = 0; step < kFitSteps; ++step) {
    normal = 1e-9 * Eigen::MatrixXd::Identity(n, n);
    right = Vector::Zero(n);
    for (std::size_t p = 0; p < num_pairs; ++p) {
      const Vector r = residuals(p, values);
      Eigen::MatrixXd jacobian(r.size(), n);
      for (Eigen::Index i = 0; i < n; ++i) {
        Vector moved = values;
        moved[i] += kStep;
        Vector before = values;
        before[i] -= kStep;
        jacobian.col(i) = (residuals(p, moved) - residuals(p, before)) / (2 * kStep);
      }
      Vector weights(r.size());
      for (Eigen::Index i = 0; i < r.size(); i += 3)
        weights.segment<3>(i).setConstant(1 / (1 + r.segment<3>(i).squaredNorm() / 9));
      normals[p] = jacobian.transpose() * weights.asDiagonal() * jacobian;
      rights[p] = -jacobian.transpose() * weights.asDiagonal() * r;
      normal += normals[p];
      right += rights[p];
    }
    Vector change = normal.ldlt().solve(right);
    const double largest = change.cwiseAbs().maxCoeff();
    if (!std::isfinite(largest)) break;
    if (largest > 0.3) change *= 0.3 / largest;
    values += change;
    if (largest < 1e-6) break;
  }
  // Jackknife: one more step from the solution without each pair.
  const auto num = static_cast<double>(num_pairs);
  Vector sum_sq = Vector::Zero(n);
  for (std::size_t p = 0; p < num_pairs; ++p)
    sum_sq += Vector((normal - normals[p]).ldlt().solve(right - rights[p])).cwiseAbs2();
  return {values, ((num - 1) / num * sum_sq).cwiseSqrt()};
}

Camera change_camera(Camera camera, double log_focal, double x_px, double y_px) {
  camera.fx *= std::exp(log_focal);
  camera.fy *= std::exp(log_focal);
  camera.cx += x_px;
  camera.cy += y_px;
  return camera;
}

/// The scale that makes the given translations as long as the measured ones, median over the pairs.
std::optional<double> find_rough_log_scale(std::span<const ViewPair> pairs, std::span<const Rigid3> given) {
  std::vector<double> logs;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const double measured = pairs[i].b_from_a.translation.norm();
    const double length = given[i].translation.norm();
    if (measured > kMinTranslation && length > 0) logs.push_back(std::log(measured / length));
  }
  if (logs.empty()) return std::nullopt;
  return upper_median(std::move(logs));
}

}  // namespace

std::optional<IntrinsicsFit> fit_intrinsics(std::span<const ViewPair> pairs, const Camera& camera) {
  if (pairs.size() < kMinFitPairs) return std::nullopt;
  constexpr double kCenterUnit_px = 100;  // The parameters are of similar size.
  const auto residuals = [&](std::size_t p, const Vector& v) {
    const Camera changed = change_camera(camera, v[0], kCenterUnit_px * v[1], kCenterUnit_px * v[2]);
    return match_residuals(pairs[p].matches, changed, refine_motion(pairs[p].matches, changed, pairs[p].b_from_a));
  };
  const ParameterFit fit = fit_parameters(pairs.size(), Vector::Zero(3), residuals);
  return IntrinsicsFit{{fit.values[0], fit.standard_errors[0]},
                       {kCenterUnit_px * fit.values[1], kCenterUnit_px * fit.standard_errors[1]},
                       {kCenterUnit_px * fit.values[2], kCenterUnit_px * fit.standard_errors[2]}};
}

GivenPosesFit evaluate_poses(std::span<const ViewPair> pairs, const Camera& camera, const GivenMotion& motion) {
  GivenPosesFit fit;
  for (const ViewPair& pair : pairs)
    if (const std::optional<Rigid3> given = motion(pair))
      fit.pair_errors_px.push_back(median_error_px(pair.matches, camera, *given));
  fit.error_px = upper_median(fit.pair_errors_px);
  return fit;
}

GivenPosesFit fit_pose_scale(std::span<const ViewPair> pairs, const Camera& camera, const GivenMotion& motion) {
  std::vector<ViewPair> reached;
  std::vector<Rigid3> given;
  for (const ViewPair& pair : pairs)
    if (const std::optional<Rigid3> b_from_a = motion(pair)) {
      reached.push_back(pair);
      given.push_back(*b_from_a);
    }
  const std::optional<double> rough = find_rough_log_scale(reached, given);
  if (!rough) return evaluate_poses(pairs, camera, motion);
  const auto scaled = [&](std::size_t p, double log_scale) {
    Rigid3 b_from_a = given[p];
    b_from_a.translation *= std::exp(log_scale);
    return b_from_a;
  };
  const ParameterFit fitted = fit_parameters(
      reached.size(), Vector::Constant(1, *rough),
      [&](std::size_t p, const Vector& v) { return match_residuals(reached[p].matches, camera, scaled(p, v[0])); });
  GivenPosesFit fit;
  fit.log_scale = {fitted.values[0], fitted.standard_errors[0]};
  for (std::size_t p = 0; p < reached.size(); ++p)
    fit.pair_errors_px.push_back(median_error_px(reached[p].matches, camera, scaled(p, fitted.values[0])));
  fit.error_px = upper_median(fit.pair_errors_px);
  return fit;
}

}  // namespace resight
