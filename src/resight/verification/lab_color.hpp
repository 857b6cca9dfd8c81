// SPDX-License-Identifier: Apache-2.0
#pragma once
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
[[nodiscard]] std::vector<LabColor> to_lab(std::span<const Rgb8> colors);

/// Maps the model's lightness to the exposure of the scene: l' = gain * l + offset.
struct ExposureMap {
  float gain = 1;
  float offset = 0;
  [[nodiscard]] float operator()(float l) const { return gain * l + offset; }
};

/// Equal mean and contrast (standard deviation) of the model's lightness and the scene's, as far as the limits allow: a
/// moment match in place of V4R's histogram specification, which can map any object's lightness onto any other's. The
/// mean moves by at most `max_shift`, the contrast by a factor of at most `max_gain`. Fewer than ten samples: identity.
[[nodiscard]] ExposureMap fit_exposure(std::span<const float> model_l, std::span<const float> scene_l, float max_shift,
                                       float max_gain);

}  // namespace resight
