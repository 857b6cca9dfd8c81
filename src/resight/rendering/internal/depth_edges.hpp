// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cmath>

#include "resight/core/image.hpp"

namespace resight {

inline constexpr double kDepthEdgeJump = 0.03;  ///< Share of z; a larger step is a discontinuity.

/// Whether a neighbour of the pixel is missing or beyond a discontinuity.
[[nodiscard]] inline bool is_beside_depth_edge(const Image<float>& depth_m, int u, int v) {
  const float z = depth_m(u, v);
  for (int dv = -1; dv <= 1; ++dv)
    for (int du = -1; du <= 1; ++du) {
      if (!depth_m.contains(u + du, v + dv)) continue;
      const float other = depth_m(u + du, v + dv);
      if (std::isnan(other) || std::abs(other - z) > kDepthEdgeJump * z) return true;
    }
  return false;
}

}  // namespace resight
