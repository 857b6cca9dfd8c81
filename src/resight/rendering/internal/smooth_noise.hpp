// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>

#include "resight/core/image.hpp"

namespace resight {

/// Standard normal noise over an image that is correlated over `cell_px` pixels: independent values on a grid, with
/// linear interpolation and constant variance between them.
class SmoothNoise {
 public:
  SmoothNoise() = default;
  SmoothNoise(int width, int height, double cell_px, std::uint64_t seed);
  [[nodiscard]] float at(double u, double v) const;

 private:
  double cells_per_px_ = 0;
  Image<float> grid_;
};

/// Share of the standard normal distribution below x: makes smooth noise uniform in (0, 1).
[[nodiscard]] double normal_share_below(double x);

}  // namespace resight
