// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>

namespace resight {

/// Regular bins of directions around the origin, Eq. (4). Deviations from the paper: atan2 replaces arctan(y/x), which
/// confuses opposite quadrants. The pole lies along the y axis of the camera (vertical), not along the viewing axis,
/// where the bins degenerate in the middle of the image. theta covers pi, so there are half as many rows as columns.
class SphericalBins {
 public:
  /// `bin_size_rad` in [0.001, pi/2] (paper: 2 deg) is reduced to the next size that divides pi, so that all bins are
  /// equal.
  explicit SphericalBins(double bin_size_rad = 0.0349066);
  [[nodiscard]] int num_bins() const { return num_theta_ * num_phi_; }
  /// Bin of the direction of a point, in row-major order (rows are theta); -1 for the origin and for NaN.
  [[nodiscard]] int bin(const Eigen::Vector3f& p_in_camera) const;

 private:
  int num_theta_;
  int num_phi_;
  float inverse_size_;
};

}  // namespace resight
