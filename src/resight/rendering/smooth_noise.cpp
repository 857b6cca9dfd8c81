// SPDX-License-Identifier: Apache-2.0
#include "resight/rendering/internal/smooth_noise.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "resight/core/random.hpp"

namespace resight {

SmoothNoise::SmoothNoise(int width, int height, double cell_px, std::uint64_t seed) : cells_per_px_(1 / cell_px) {
  Rng rng(seed);
  grid_ = Image<float>(static_cast<int>(width * cells_per_px_) + 3, static_cast<int>(height * cells_per_px_) + 3);
  for (float& value : grid_.data()) value = static_cast<float>(rng.normal());
}

float SmoothNoise::at(double u, double v) const {
  const double x = std::clamp(u * cells_per_px_, 0.0, static_cast<double>(grid_.width()) - 1.001);
  const double y = std::clamp(v * cells_per_px_, 0.0, static_cast<double>(grid_.height()) - 1.001);
  const int x0 = static_cast<int>(x);
  const int y0 = static_cast<int>(y);
  const auto ax = static_cast<float>(x - x0);
  const auto ay = static_cast<float>(y - y0);
  const float sum = (1 - ay) * ((1 - ax) * grid_(x0, y0) + ax * grid_(x0 + 1, y0)) +
                    ay * ((1 - ax) * grid_(x0, y0 + 1) + ax * grid_(x0 + 1, y0 + 1));
  return sum / std::sqrt(((1 - ax) * (1 - ax) + ax * ax) * ((1 - ay) * (1 - ay) + ay * ay));
}

double normal_share_below(double x) { return 0.5 * std::erfc(-x / std::numbers::sqrt2); }

}  // namespace resight
