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

/// Tolerance of colour comparisons between a known colour and one that is seen. Standard deviations of each: of l; of a
/// and b of a grey; and of the saturation, as a share of it: cameras, gloss and a second light scale saturation, so
/// that the tolerance of a and b grows with the chromaticity of the known colour, while grey stays grey.
class ColorTolerance {
 public:
  ColorTolerance(double sigma_l, double sigma_ab, double sigma_saturation = 0)
      : inverse_l_(static_cast<float>(1 / (4 * sigma_l * sigma_l))),
        four_variance_ab_(static_cast<float>(4 * sigma_ab * sigma_ab)),
        four_variance_saturation_(static_cast<float>(4 * sigma_saturation * sigma_saturation)) {}
  /// Negative log of the similarity of two colours, (dl / (2 sigma_l))^2 + (da^2 + db^2) / (2 sigma)^2 with sigma^2 =
  /// sigma_ab^2 + sigma_saturation^2 (a^2 + b^2), a and b of `known`.
  [[nodiscard]] float exponent(const LabColor& known, const LabColor& seen) const {
    const float dl = known.l - seen.l;
    const float da = known.a - seen.a;
    const float db = known.b - seen.b;
    const float four_variance = four_variance_ab_ + four_variance_saturation_ * (known.a * known.a + known.b * known.b);
    return dl * dl * inverse_l_ + (da * da + db * db) / four_variance;
  }

 private:
  float inverse_l_;
  float four_variance_ab_;
  float four_variance_saturation_;
};

/// What a camera without chromaticity shows of a colour, as r = g = b (luma of ITU-R BT.601, the usual conversion).
[[nodiscard]] Rgb8 to_grey(Rgb8 color);

/// Converts an sRGB colour.
[[nodiscard]] LabColor to_lab(Rgb8 color);
[[nodiscard]] LabColor to_lab(const Eigen::Vector3f& linear_light);  ///< Linear RGB channels in [0, 1].
[[nodiscard]] std::vector<LabColor> to_lab(std::span<const Eigen::Vector3f> linear_light);

}  // namespace resight
