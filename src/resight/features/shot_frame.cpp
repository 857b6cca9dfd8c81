// SPDX-License-Identifier: Apache-2.0
#include "resight/features/shot_frame.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace resight {
namespace {

// Relative to the largest eigenvalue. Below the first limit, rounding errors determine the axes. Below the second, the
// support is a plane to single precision, and the sign of its normal is undefined.
constexpr double kMinEigenvalueGap = 1e-3;
constexpr double kMinThickness = 1e-7;
// Smallest ratio of the sum of projections to the sum of their magnitudes that decides a tie of the counts.
constexpr float kMinBalance = 1e-3F;

constexpr int kLanes = Neighborhood::kLanes;
using Lanes = Eigen::Array<float, kLanes, 1>;

/// Eigen fixes the order of additions by the number of lanes, not by the address, which gives the same bits on any
/// thread.
Lanes load(const std::vector<float>& values, int i) { return Lanes::Map(values.data() + i); }

/// Second moments sum(w d d^T) of the differences to the keypoint, with w = 1 or radius - distance.
struct Moments {
  double weight = 0;
  Eigen::Vector3d first = Eigen::Vector3d::Zero();
  Eigen::Matrix3d second = Eigen::Matrix3d::Zero();
};

template <typename Weight>
Moments sum_moments(const Neighborhood& n, Weight&& weight_of) {
  Lanes w_sum = Lanes::Zero(), x = w_sum, y = w_sum, z = w_sum;
  Lanes xx = w_sum, xy = w_sum, xz = w_sum, yy = w_sum, yz = w_sum, zz = w_sum;
  for (int i = 0; i < n.count; i += kLanes) {  // The padding has zero differences; its weight is subtracted below.
    const Lanes w = weight_of(load(n.distance, i));
    const Lanes dx = load(n.dx, i);
    const Lanes dy = load(n.dy, i);
    const Lanes dz = load(n.dz, i);
    const Lanes wx = w * dx;
    const Lanes wy = w * dy;
    const Lanes wz = w * dz;
    w_sum += w;
    x += wx;
    y += wy;
    z += wz;
    xx += wx * dx;
    xy += wx * dy;
    xz += wx * dz;
    yy += wy * dy;
    yz += wy * dz;
    zz += wz * dz;
  }
  const int num_padding = (kLanes - n.count % kLanes) % kLanes;
  Moments m;
  m.weight = static_cast<double>(w_sum.sum()) - num_padding * static_cast<double>(Lanes(weight_of(Lanes::Zero()))[0]);
  m.first = {x.sum(), y.sum(), z.sum()};
  m.second << xx.sum(), xy.sum(), xz.sum(), xy.sum(), yy.sum(), yz.sum(), xz.sum(), yz.sum(), zz.sum();
  return m;
}

/// +1 or -1 such that `axis` points to the side with more neighbours; 0 if both sides balance.
float majority_sign(const Neighborhood& n, const Eigen::Vector3f& axis, float radius_m) {
  int num_ahead = 0;
  for (int i = 0; i < n.count; ++i)
    num_ahead += n.dx[i] * axis.x() + n.dy[i] * axis.y() + n.dz[i] * axis.z() >= 0 ? 1 : 0;
  const int surplus = 2 * num_ahead - n.count;
  if (surplus != 0) return surplus > 0 ? 1.0F : -1.0F;
  float sum = 0;
  float size = 0;
  for (int i = 0; i < n.count; ++i) {
    const float projection =
        (radius_m - n.distance[i]) * (n.dx[i] * axis.x() + n.dy[i] * axis.y() + n.dz[i] * axis.z());
    sum += projection;
    size += std::abs(projection);
  }
  if (std::abs(sum) <= kMinBalance * size) return 0;
  return sum > 0 ? 1.0F : -1.0F;
}

}  // namespace

double surface_variation(const Neighborhood& neighborhood, double noise_variance_sq_m) {
  if (neighborhood.count < 3) return 0;
  const Moments m = sum_moments(neighborhood, [](const Lanes&) { return Lanes::Ones(); });
  const Eigen::Vector3d mean = m.first / m.weight;
  const Eigen::Matrix3d covariance = m.second / m.weight - mean * mean.transpose();
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver;
  solver.computeDirect(covariance, Eigen::EigenvaluesOnly);
  return covariance.trace() > 0 ? std::max(0.0, solver.eigenvalues()[0] - noise_variance_sq_m) / covariance.trace() : 0;
}

std::optional<Eigen::Matrix3f> local_reference_frame(const Neighborhood& neighborhood, double radius_m) {
  const auto radius = static_cast<float>(radius_m);
  const Moments m = sum_moments(neighborhood, [radius](const Lanes& distance) { return Lanes(radius - distance); });
  if (!(m.weight > 0)) return std::nullopt;
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(m.second / m.weight);
  const Eigen::Vector3d& l = solver.eigenvalues();
  if (!(l[1] - l[0] > kMinEigenvalueGap * l[2]) || !(l[2] - l[1] > kMinEigenvalueGap * l[2]) ||
      !(l[0] > kMinThickness * l[2]))
    return std::nullopt;
  Eigen::Vector3f x = solver.eigenvectors().col(2).cast<float>();
  Eigen::Vector3f z = solver.eigenvectors().col(0).cast<float>();
  const float x_sign = majority_sign(neighborhood, x, radius);
  const float z_sign = majority_sign(neighborhood, z, radius);
  if (x_sign == 0 || z_sign == 0) return std::nullopt;
  x *= x_sign;
  z *= z_sign;
  Eigen::Matrix3f frame;
  frame.row(0) = x;
  frame.row(1) = z.cross(x);
  frame.row(2) = z;
  return frame;
}

}  // namespace resight
