// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <limits>

#include "resight/sensor/rgbd_frame.hpp"

namespace resight {

/// A larger depth bias is a wrong unit or follows another law.
inline constexpr double kMaxDepthBias_per_m = 0.05;

/// Depth without the bias that a constant error of the disparity causes: 1 / z = 1 / measured_m - bias_per_m. NaN where
/// no disparity is left, and for NaN.
[[nodiscard]] inline float without_disparity_error_m(float measured_m, double bias_per_m) {
  const auto share = static_cast<float>(1 - bias_per_m * static_cast<double>(measured_m));
  return share > 0 ? depth_or_none(measured_m / share) : std::numeric_limits<float>::quiet_NaN();
}

/// Corrects all depth of a frame.
inline void remove_disparity_error(double bias_per_m, RgbdFrame& frame) {
  for (std::size_t i = 0; i < frame.depth_m.size(); ++i)
    frame.depth_m[i] = without_disparity_error_m(frame.depth_m[i], bias_per_m);
}

}  // namespace resight
