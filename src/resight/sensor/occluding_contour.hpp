// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cmath>

#include "resight/core/image.hpp"

namespace resight {

struct PixelStep {
  int u, v;
};
/// To the four neighbours.
inline constexpr std::array<PixelStep, 4> kPixelSteps{{{1, 0}, {-1, 0}, {0, 1}, {0, -1}}};

/// Whether the surface of a pixel ends in this direction, before one that lies behind it by at least a twentieth of the
/// depth. Up to 7 missing pixels between them are bridged.
[[nodiscard]] inline bool is_occluding_contour(const Image<float>& depth_m, int u, int v, PixelStep towards) {
  constexpr int kMaxSteps = 8;
  constexpr float kMinDepthRatio = 1.05F;
  for (int step = 1; step <= kMaxSteps; ++step) {
    const int at_u = u + step * towards.u;
    const int at_v = v + step * towards.v;
    if (!depth_m.contains(at_u, at_v)) return false;
    if (!std::isnan(depth_m(at_u, at_v))) return depth_m(at_u, at_v) > kMinDepthRatio * depth_m(u, v);
  }
  return false;
}

}  // namespace resight
