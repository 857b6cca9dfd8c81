// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <span>
#include <vector>

#include "resight/core/image.hpp"

namespace resight {

/// CIELAB (D65) scaled as in V4R to about [-1, 1]: l = (L - 50)/50, a = a*/128, b = b*/128.
struct LabColor {
  float l = 0;
  float a = 0;
  float b = 0;
};

/// Tolerance of colour comparisons: standard deviations of l, and of a and b, between observations of one surface.
class ColorTolerance {
 public:
  ColorTolerance(double sigma_l, double sigma_ab)
      : inverse_l_(static_cast<float>(1 / (4 * sigma_l * sigma_l))),
        inverse_ab_(static_cast<float>(1 / (4 * sigma_ab * sigma_ab))) {}
  /// Negative log of the similarity of two colours, (dl / (2 sigma_l))^2 + (da^2 + db^2) / (2 sigma_ab)^2.
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

/// Converts an sRGB colour.
[[nodiscard]] LabColor to_lab(Rgb8 color);
[[nodiscard]] LabColor to_lab(const Eigen::Vector3f& linear_light);  ///< Linear RGB channels in [0, 1].
[[nodiscard]] std::vector<LabColor> to_lab(std::span<const Eigen::Vector3f> linear_light);

}  // namespace resight
