// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <span>
#include <vector>

#include "resight/core/image.hpp"

namespace resight {

/// CIELAB (D65) scaled as in V4R: l = (L - 50)/50, a = a*/128, b = b*/128, each about [-1, 1].
struct LabColor {
  float l = 0;
  float a = 0;
  float b = 0;
};

[[nodiscard]] LabColor to_lab(Rgb8 color);
[[nodiscard]] LabColor to_lab(const Eigen::Vector3f& linear_light);  ///< Channels in [0, 1].
[[nodiscard]] std::vector<LabColor> to_lab(std::span<const Eigen::Vector3f> linear_light);

}  // namespace resight
