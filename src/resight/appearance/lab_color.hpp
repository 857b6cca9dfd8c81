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

/// How much colours of one thing differ, as standard deviations of l and of a, b.
class ColorTolerance {
 public:
  ColorTolerance(double sigma_l, double sigma_ab)
      : inverse_l_(static_cast<float>(1 / (4 * sigma_l * sigma_l))),
        inverse_ab_(static_cast<float>(1 / (4 * sigma_ab * sigma_ab))) {}
  /// -log of the similarity of two colours.
  [[nodiscard]] float exponent(const LabColor& p, const LabColor& q) const {
    const float dl = p.l - q.l;
    const float da = p.a - q.a;
    const float db = p.b - q.b;
    return dl * dl * inverse_l_ + (da * da + db * db) * inverse_ab_;
  }

 private:
  float inverse_l_;
  float inverse_ab_;
};

[[nodiscard]] LabColor to_lab(Rgb8 color);
[[nodiscard]] LabColor to_lab(const Eigen::Vector3f& linear_light);  ///< Channels in [0, 1].
[[nodiscard]] std::vector<LabColor> to_lab(std::span<const Eigen::Vector3f> linear_light);

}  // namespace resight
