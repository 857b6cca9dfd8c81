// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "resight/core/image.hpp"

namespace resight {

/// What the values of a depth image tell without any other image.
struct DepthValues {
  double measured_share = 0;  ///< Share of pixels with depth.
  double near_m = 0;          ///< 5 % of the measured depths are smaller; NaN without depth.
  double median_m = 0;
  double far_m = 0;    ///< 5 % are larger.
  int num_levels = 0;  ///< Different values.
  double step_m = 0;   ///< Median distance of neighbouring levels between near_m and far_m; NaN for one level.
  /// Whether all levels are multiples of one step, the largest of at most 256: depth of eight bits. The steps of a
  /// sensor with coarse disparities grow with depth, and those of a file in millimetres are too many, or too fine.
  bool has_eight_bits = false;
};

[[nodiscard]] DepthValues measure_depth_values(const Image<float>& depth_m);

/// Standard deviation of smooth surfaces over the law of the sensor (nguyen_noise()), the median over blocks of 9x9
/// pixels: planes, which are linear in inverse depth whatever the intrinsics, are fitted to the blocks. NaN if fewer
/// than 20 blocks are fully measured. `focal_px` serves the law only.
[[nodiscard]] double measure_noise_ratio(const Image<float>& depth_m, double focal_px);

}  // namespace resight
