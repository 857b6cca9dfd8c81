// SPDX-License-Identifier: Apache-2.0
#include "resight/core/srgb.hpp"

#include <algorithm>
#include <cmath>

namespace resight {

float encode_srgb(float linear) {
  const float x = std::clamp(linear, 0.0F, 1.0F);
  return 255 * (x <= 0.0031308F ? 12.92F * x : 1.055F * std::pow(x, 1 / 2.4F) - 0.055F);
}

float decode_srgb(float encoded_255) {
  const float x = encoded_255 / 255;
  return x <= 0.04045F ? x / 12.92F : std::pow((x + 0.055F) / 1.055F, 2.4F);
}

}  // namespace resight
