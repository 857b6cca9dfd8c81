// SPDX-License-Identifier: Apache-2.0
#include "resight/registration/point_to_plane.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <algorithm>
#include <numeric>

namespace resight {
namespace {

// Damping as a share of the mean information. It holds directions that no pair constrains.
constexpr double kDamping = 1e-3;

}  // namespace

void StepEquations::add(const Eigen::Vector3d& arm, const Eigen::Vector3d& normal, double residual, double weight,
                        double radius_m) {
  Vector6 row = point_to_plane_row(arm, normal);
  row.head<3>() /= radius_m;
  add_row(row, residual, weight);
  sum_weights += weight;
  sum_residuals_sq += weight * residual * residual;
  ++num_pairs;
}

double StepEquations::step(Rigid3& pose, const Eigen::Vector3d& middle, double radius_m) const {
  Matrix6 damped = matrix;
  damped.diagonal().array() += kDamping * matrix.trace() / 6;
  const Vector6 x = damped.ldlt().solve(right);
  const Eigen::Vector3d rotation = x.head<3>() / radius_m;
  const Eigen::Vector3d moved_middle = pose * middle;
  pose.rotation =
      Eigen::AngleAxisd(rotation.norm(), rotation.norm() > 0 ? rotation.normalized() : Eigen::Vector3d::UnitX())
          .toRotationMatrix() *
      pose.rotation;
  pose.translation = moved_middle + x.tail<3>() - pose.rotation * middle;
  return x.norm();
}

void BlockEquations::add(const PairBlock& pairs) {
  std::array<PairBlock::Lanes, kRow> row;
  std::array<PairBlock::Lanes, kRow> weighted;
  const auto& [x, y, z] = pairs.arm;
  const auto& [nx, ny, nz] = pairs.normal;
  for (std::size_t k = 0; k < PairBlock::kSize; ++k) {
    row[0][k] = (y[k] * nz[k] - z[k] * ny[k]) * inverse_radius_;
    row[1][k] = (z[k] * nx[k] - x[k] * nz[k]) * inverse_radius_;
    row[2][k] = (x[k] * ny[k] - y[k] * nx[k]) * inverse_radius_;
    row[3][k] = nx[k];
    row[4][k] = ny[k];
    row[5][k] = nz[k];
    row[6][k] = pairs.residual[k];
    weights_[k] += pairs.weight[k];
    num_pairs_[k] += pairs.weight[k] > 0 ? 1 : 0;
  }
  for (std::size_t i = 0; i < kRow; ++i)
    for (std::size_t k = 0; k < PairBlock::kSize; ++k) weighted[i][k] = pairs.weight[k] * row[i][k];
  for (std::size_t i = 0, product = 0; i < kRow; ++i)
    for (std::size_t j = 0; j <= i; ++j, ++product)
      for (std::size_t k = 0; k < PairBlock::kSize; ++k) products_[product][k] += weighted[i][k] * row[j][k];
}

void BlockEquations::add(const Eigen::Vector3f& arm, const Eigen::Vector3f& normal, float residual, float weight) {
  for (std::size_t i = 0; i < 3; ++i) {
    kept_.arm[i][num_kept_] = arm[static_cast<Eigen::Index>(i)];
    kept_.normal[i][num_kept_] = normal[static_cast<Eigen::Index>(i)];
  }
  kept_.residual[num_kept_] = residual;
  kept_.weight[num_kept_] = weight;
  if (++num_kept_ < PairBlock::kSize) return;
  add(kept_);
  num_kept_ = 0;
}

void BlockEquations::add_point(const Eigen::Vector3f& arm, const Eigen::Vector3f& offset, float weight) {
  for (int axis = 0; axis < 3; ++axis) add(arm, Eigen::Vector3f::Unit(axis), offset[axis], weight);
}

StepEquations BlockEquations::sum() {
  std::fill(kept_.weight.begin() + static_cast<std::ptrdiff_t>(num_kept_), kept_.weight.end(), 0.0F);
  if (num_kept_ > 0) add(kept_);
  num_kept_ = 0;
  const auto total = [](const PairBlock::Lanes& lanes) { return std::accumulate(lanes.begin(), lanes.end(), 0.0); };
  StepEquations result;
  std::size_t product = 0;
  for (int i = 0; i < kRow - 1; ++i)
    for (int j = 0; j <= i; ++j) result.matrix(i, j) = result.matrix(j, i) = total(products_[product++]);
  for (int j = 0; j < kRow - 1; ++j) result.right[j] = total(products_[product++]);
  result.sum_residuals_sq = total(products_[product]);
  result.sum_weights = total(weights_);
  result.num_pairs = std::accumulate(num_pairs_.begin(), num_pairs_.end(), 0);
  return result;
}

}  // namespace resight
