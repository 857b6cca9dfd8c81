// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <algorithm>
#include <cmath>

#include "resight/core/image.hpp"
#include "resight/core/random.hpp"
#include "resight/geometry/camera.hpp"
#include "resight/sensor/rgbd_frame.hpp"

/// Analytic views for tests of features.
namespace resight::test {

inline Camera feature_camera() { return {320, 240, 300.0, 300.0, 159.5, 119.5}; }

/// A wavy, textured surface at a distance of about 0.8 m. Depth and colour are functions of the pixel and of `seed`.
inline RgbdFrame make_wavy_frame(std::uint64_t seed) {
  RgbdFrame frame;
  frame.name = "wavy";
  frame.camera = feature_camera();
  frame.color = Image<Rgb8>(frame.camera.width, frame.camera.height);
  frame.depth_m = Image<float>(frame.camera.width, frame.camera.height);
  Rng rng(seed);
  struct Wave {
    double fx, fy, phase, height;
  };
  std::vector<Wave> waves;
  for (int i = 0; i < 12; ++i)
    waves.push_back({rng.uniform(-0.12, 0.12), rng.uniform(-0.12, 0.12), rng.uniform(0, 6.28), rng.uniform(0.2, 1)});
  for (int v = 0; v < frame.camera.height; ++v)
    for (int u = 0; u < frame.camera.width; ++u) {
      double shade = 0;
      double height = 0;
      for (const Wave& w : waves) {
        shade += w.height * std::sin(3 * (w.fx * u + w.fy * v) + w.phase);
        height += w.height * std::sin(w.fx * u + w.fy * v + 2 * w.phase);
      }
      const auto level = static_cast<std::uint8_t>(128 + std::min(120.0, std::max(-120.0, 30 * shade)));
      frame.color(u, v) = {level, level, static_cast<std::uint8_t>(level / 2 + 40)};
      frame.depth_m(u, v) = static_cast<float>(0.8 + 0.006 * height);
    }
  return frame;
}

}  // namespace resight::test
