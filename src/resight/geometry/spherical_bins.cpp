// SPDX-License-Identifier: Apache-2.0
#include "resight/geometry/spherical_bins.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "resight/core/check.hpp"

namespace resight {
namespace {

int count_rows(double bin_size_rad) {
  check_in_range("bin_size_rad", bin_size_rad, 0.001, std::numbers::pi / 2);
  constexpr double kRounding = 1e-3;  // 2 deg given as 0.03490658 (90.00001 rows) gives 90 rows, not 91
  return static_cast<int>(std::ceil(std::numbers::pi / bin_size_rad - kRounding));
}

}  // namespace

SphericalBins::SphericalBins(double bin_size_rad)
    : num_theta_(count_rows(bin_size_rad)),
      num_phi_(2 * num_theta_),
      inverse_size_(static_cast<float>(num_theta_ / std::numbers::pi)) {}

int SphericalBins::bin(const Eigen::Vector3f& p_in_camera) const {
  const float level = std::sqrt(p_in_camera.x() * p_in_camera.x() + p_in_camera.z() * p_in_camera.z());
  if (!(level > 0 || std::abs(p_in_camera.y()) > 0) || !p_in_camera.allFinite()) return -1;
  constexpr float kPi = std::numbers::pi_v<float>;
  const float theta = std::atan2(level, p_in_camera.y());                // [0, pi] from the +y axis
  const float phi = kPi + std::atan2(p_in_camera.x(), p_in_camera.z());  // [0, 2 pi]; pi is straight ahead
  const int row = std::clamp(static_cast<int>(theta * inverse_size_), 0, num_theta_ - 1);
  const int column = static_cast<int>(phi * inverse_size_) % num_phi_;  // 2 pi wraps to 0
  return row * num_phi_ + column;
}

}  // namespace resight
