// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "resight/sensor/rgbd_frame.hpp"

namespace resight::test {

/// The frame of a camera with pixels a quarter as wide.
inline RgbdFrame enlarge(const RgbdFrame& frame) {
  constexpr int kFactor = 4;
  const Camera& c = frame.camera;
  RgbdFrame large{frame.name,
                  {kFactor * c.width, kFactor * c.height, kFactor * c.fx, kFactor * c.fy, kFactor * (c.cx + 0.5) - 0.5,
                   kFactor * (c.cy + 0.5) - 0.5},
                  Image<Rgb8>(kFactor * c.width, kFactor * c.height),
                  Image<float>(kFactor * c.width, kFactor * c.height),
                  frame.world_from_camera};
  for (int v = 0; v < large.camera.height; ++v)
    for (int u = 0; u < large.camera.width; ++u) {
      large.color(u, v) = frame.color(u / kFactor, v / kFactor);
      large.depth_m(u, v) = frame.depth_m(u / kFactor, v / kFactor);
    }
  return large;
}

}  // namespace resight::test
