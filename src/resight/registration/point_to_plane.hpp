// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <array>

#include "resight/geometry/rigid3.hpp"

namespace resight {

/// The normal equations of one step of point-to-plane ICP (Chen and Medioni 1992): a turn about the middle of the moved
/// points and a shift, both in the frame they are moved in. Turns are scaled to metres by the radius of the points, so
/// that the damping treats both alike.
struct StepEquations {
  static constexpr double kStill_m = 1e-4;  ///< A pose whose steps are shorter stands still.
  Eigen::Matrix<double, 6, 6> matrix = Eigen::Matrix<double, 6, 6>::Zero();
  Eigen::Matrix<double, 6, 1> right = Eigen::Matrix<double, 6, 1>::Zero();
  double sum_weights = 0;
  double sum_residuals_sq = 0;  ///< Weighted.
  int num_pairs = 0;

  /// `arm`: the point from the middle; `residual`: how far it is to move along `normal`.
  void add(const Eigen::Vector3d& arm, const Eigen::Vector3d& normal, double residual, double weight, double radius_m);
  /// Moves the pose, `middle` in the frame of the object. How far: metres, and radians times the radius. Needs a pair.
  double step(Rigid3& pose, const Eigen::Vector3d& middle, double radius_m) const;
};

/// Eight pairs side by side, for vector instructions. Of weight 0: none, its other numbers finite.
struct PairBlock {
  static constexpr int kSize = 8;
  using Lanes = std::array<float, kSize>;
  std::array<Lanes, 3> arm;
  std::array<Lanes, 3> normal;
  Lanes residual;
  Lanes weight;
};

/// Sums up StepEquations by blocks of pairs, in single precision.
class BlockEquations {
 public:
  explicit BlockEquations(double radius_m) : inverse_radius_(static_cast<float>(1 / radius_m)) {}
  void add(const PairBlock& pairs);
  /// One pair as in StepEquations, kept until there are eight.
  void add(const Eigen::Vector3f& arm, const Eigen::Vector3f& normal, float residual, float weight);
  /// A pair of points that should coincide.
  void add_point(const Eigen::Vector3f& arm, const Eigen::Vector3f& offset, float weight);
  [[nodiscard]] StepEquations sum();

 private:
  static constexpr int kRow = 7;  // Turn, shift and residual.
  float inverse_radius_;
  std::array<PairBlock::Lanes, kRow*(kRow + 1) / 2> products_{};  // Lower triangle of the rows' products, by rows.
  PairBlock::Lanes weights_{};
  std::array<int, PairBlock::kSize> num_pairs_{};
  PairBlock kept_{};
  std::size_t num_kept_ = 0;
};

}  // namespace resight
