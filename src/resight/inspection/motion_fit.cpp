// SPDX-License-Identifier: Apache-2.0
#include "resight/inspection/motion_fit.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>

#include "resight/core/statistics.hpp"

namespace resight {
namespace {

constexpr int kFitSteps = 8;
constexpr double kStep = 1e-4;            // Of the numerical derivative.
constexpr double kMinTranslation = 0.01;  // Share of the distance of the scene; shorter ones tell no scale.

/// Up to three parameters; the residuals do not depend on those that are not used.
using Parameters = Eigen::Vector3d;
using PairResiduals = std::function<std::vector<Eigen::Vector3d>(std::size_t pair, const Parameters& parameters)>;

struct ParameterFit {
  Parameters values;
  Parameters standard_errors;
};

/// Normal equations of one pair.
struct PairEquations {
  Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
  Eigen::Vector3d right = Eigen::Vector3d::Zero();
};

/// With Cauchy's weights and numerical derivatives.
PairEquations linearize_pair(std::size_t pair, const Parameters& values, const PairResiduals& residuals) {
  const std::vector<Eigen::Vector3d> r = residuals(pair, values);
  std::array<std::vector<Eigen::Vector3d>, 3> after, before;
  for (int i = 0; i < 3; ++i) {
    const Parameters step = kStep * Parameters::Unit(i);
    after[static_cast<std::size_t>(i)] = residuals(pair, values + step);
    before[static_cast<std::size_t>(i)] = residuals(pair, values - step);
  }
  PairEquations equations;
  for (std::size_t m = 0; m < r.size(); ++m) {
    Eigen::Matrix3d jacobian;
    for (int i = 0; i < 3; ++i) {
      const auto column = static_cast<std::size_t>(i);
      jacobian.col(i) = (after[column][m] - before[column][m]) / (2 * kStep);
    }
    const double weight = 1 / (1 + r[m].squaredNorm() / 9);
    equations.normal += weight * jacobian.transpose() * jacobian;
    equations.right -= weight * jacobian.transpose() * r[m];
  }
  return equations;
}

/// Gauss-Newton steps over all pairs.
ParameterFit fit_parameters(std::size_t num_pairs, Parameters values, const PairResiduals& residuals) {
  std::vector<PairEquations> pairs(num_pairs);
  Eigen::Matrix3d normal;
  Eigen::Vector3d right;
  for (int step = 0; step < kFitSteps; ++step) {
    normal = 1e-9 * Eigen::Matrix3d::Identity();
    right.setZero();
    for (std::size_t p = 0; p < num_pairs; ++p) {
      pairs[p] = linearize_pair(p, values, residuals);
      normal += pairs[p].normal;
      right += pairs[p].right;
    }
    Parameters change = normal.ldlt().solve(right);
    const double largest = change.cwiseAbs().maxCoeff();
    if (!std::isfinite(largest)) break;
    if (largest > 0.3) change *= 0.3 / largest;
    values += change;
    if (largest < 1e-6) break;
  }
  // Jackknife: one more step from the solution without each pair.
  const auto num = static_cast<double>(num_pairs);
  Eigen::Vector3d sum_sq = Eigen::Vector3d::Zero();
  for (const PairEquations& pair : pairs) {
    const Eigen::Vector3d change = (normal - pair.normal).ldlt().solve(right - pair.right);
    sum_sq += change.cwiseAbs2();
  }
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
  const auto residuals = [&](std::size_t p, const Parameters& v) {
    const Camera changed = change_camera(camera, v[0], kCenterUnit_px * v[1], kCenterUnit_px * v[2]);
    return match_residuals(pairs[p].matches, changed, refine_motion(pairs[p].matches, changed, pairs[p].b_from_a));
  };
  const ParameterFit fit = fit_parameters(pairs.size(), Parameters::Zero(), residuals);
  return IntrinsicsFit{{fit.values[0], fit.standard_errors[0]},
                       {kCenterUnit_px * fit.values[1], kCenterUnit_px * fit.standard_errors[1]},
                       {kCenterUnit_px * fit.values[2], kCenterUnit_px * fit.standard_errors[2]}};
}

GivenPosesFit evaluate_poses(std::span<const ViewPair> pairs, const Camera& camera, const GivenMotion& motion) {
  GivenPosesFit fit;
  for (const ViewPair& pair : pairs)
    if (const std::optional<Rigid3> given = pair.shows_change ? std::nullopt : motion(pair))
      fit.pair_errors_px.push_back(median_error_px(pair.matches, camera, *given));
  if (!fit.pair_errors_px.empty()) fit.error_px = upper_median(fit.pair_errors_px);
  return fit;
}

GivenPosesFit fit_pose_scale(std::span<const ViewPair> pairs, const Camera& camera, const GivenMotion& motion) {
  std::vector<ViewPair> reached;
  std::vector<Rigid3> given;
  for (const ViewPair& pair : pairs)
    if (const std::optional<Rigid3> b_from_a = pair.shows_change ? std::nullopt : motion(pair)) {
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
      reached.size(), Parameters(*rough, 0, 0),
      [&](std::size_t p, const Parameters& v) { return match_residuals(reached[p].matches, camera, scaled(p, v[0])); });
  GivenPosesFit fit;
  fit.log_scale = Estimate{fitted.values[0], fitted.standard_errors[0]};
  for (std::size_t p = 0; p < reached.size(); ++p)
    fit.pair_errors_px.push_back(median_error_px(reached[p].matches, camera, scaled(p, fitted.values[0])));
  fit.error_px = upper_median(fit.pair_errors_px);
  return fit;
}

}  // namespace resight
