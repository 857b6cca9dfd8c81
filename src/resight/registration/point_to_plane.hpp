// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <cmath>

#include "resight/geometry/rigid3.hpp"

namespace resight {

using Vector6 = Eigen::Matrix<double, 6, 1>;
using Matrix6 = Eigen::Matrix<double, 6, 6>;

/// The normal equations `matrix * x = right` of a linear least-squares problem with six unknowns, row by row.
struct NormalEquations {
  Matrix6 matrix = Matrix6::Zero();
  Vector6 right = Vector6::Zero();

  /// Adds weight * (row . x - residual)^2 to what x minimises.
  void add_row(const Vector6& row, double residual, double weight = 1) {
    for (int c = 0; c < 6; ++c) {
      const double weighted = weight * row[c];
      matrix.col(c) += weighted * row;
      right[c] += weighted * residual;
    }
  }
  NormalEquations& operator+=(const NormalEquations& other) {
    matrix += other.matrix;
    right += other.right;
    return *this;
  }
};

/// Tukey's weight of a residual in units of the largest one that counts: 1 at 0, 0 from 1 on.
[[nodiscard]] inline double tukey(double x) { return std::abs(x) < 1 ? (1 - x * x) * (1 - x * x) : 0; }

/// How the distance of a point to a plane changes with a small motion of the point, [rotation vector; shift]; `arm`:
/// the point from the centre of rotation, `normal`: of the plane (Chen and Medioni 1992).
template <typename Scalar>
[[nodiscard]] Eigen::Matrix<Scalar, 6, 1> point_to_plane_row(const Eigen::Matrix<Scalar, 3, 1>& arm,
                                                             const Eigen::Matrix<Scalar, 3, 1>& normal) {
  Eigen::Matrix<Scalar, 6, 1> row;
  row << arm.cross(normal), normal;
  return row;
}

/// Normal equations of one point-to-plane ICP step (Chen and Medioni 1992). The step is a rotation about the middle of
/// the moved points and a translation, both in the target frame. Rotations are scaled to metres by the radius of the
/// points, so that the damping treats rotation and translation alike.
struct StepEquations : NormalEquations {
  static constexpr double kStill_m = 1e-4;  ///< Shorter steps have converged.
  double sum_weights = 0;
  double sum_residuals_sq = 0;  ///< Weighted sum.
  int num_pairs = 0;

  /// Adds one pair. `arm`: the point relative to the middle; `residual`: the distance to move along `normal`, in
  /// metres.
  void add(const Eigen::Vector3d& arm, const Eigen::Vector3d& normal, double residual, double weight, double radius_m);
  /// Applies the step to the pose; `middle` is in the frame of the object. Returns the step length: metres, and radians
  /// times `radius_m`. Requires at least one pair.
  double step(Rigid3& pose, const Eigen::Vector3d& middle, double radius_m) const;
};

/// Eight contiguous pairs for vector instructions. Lanes of weight 0 hold no pair; their other values must be finite.
struct PairBlock {
  static constexpr int kSize = 8;
  using Lanes = std::array<float, kSize>;
  std::array<Lanes, 3> arm;
  std::array<Lanes, 3> normal;
  Lanes residual;
  Lanes weight;
};

/// Accumulates StepEquations from blocks of pairs, in single precision.
class BlockEquations {
 public:
  explicit BlockEquations(double radius_m) : inverse_radius_(static_cast<float>(1 / radius_m)) {}
  void add(const PairBlock& pairs);
  /// Adds one pair as in StepEquations. Pairs are buffered until a block is full.
  void add(const Eigen::Vector3f& arm, const Eigen::Vector3f& normal, float residual, float weight);
  /// Adds a pair of points that should coincide: one equation per axis.
  void add_point(const Eigen::Vector3f& arm, const Eigen::Vector3f& offset, float weight);
  [[nodiscard]] StepEquations sum();

 private:
  static constexpr int kRow = 7;  // Rotation, translation and residual.
  float inverse_radius_;
  // Lower triangle of the outer product of the rows, row by row.
  std::array<PairBlock::Lanes, kRow*(kRow + 1) / 2> products_{};
  PairBlock::Lanes weights_{};
  std::array<int, PairBlock::kSize> num_pairs_{};
  PairBlock kept_{};
  std::size_t num_kept_ = 0;
};

}  // namespace resight
