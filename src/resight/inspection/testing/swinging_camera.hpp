// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "resight/inspection/finding.hpp"
#include "resight/sensor/testing/ball_scene.hpp"
#include "resight/sensor/testing/memory_sequence.hpp"

/// A sound recording of a camera that swings around a ball.
namespace resight::test {

/// Gives the smooth texture sharp edges, as printed things have.
inline RgbdFrame sharpen(RgbdFrame frame) {
  for (Rgb8& c : frame.color.data()) c.r = c.g = c.b = c.r > 160 ? 220 : c.r > 110 ? 130 : 50;
  return frame;
}

/// Pose of a camera that swings around a ball before a wall, with changing speed.
inline Rigid3 swinging_camera(int view) {
  const double angle = -0.5 + 0.13 * view + 0.05 * (view % 3);
  const Eigen::Vector3d eye(1.1 * std::sin(angle), -1.1 * std::cos(angle), 0.75 + 0.06 * (view % 2));
  return look_at_point(eye, {0.05 * (view % 2), 0.1, 0.15});
}

inline RgbdFrame render_view(const Rigid3& pose, double noise_m, int seed) {
  RgbdFrame frame = sharpen(render_ball_scene({}, pose, noise_m, static_cast<std::uint64_t>(seed)));
  frame.name = std::to_string(seed);
  return frame;
}

inline const MemorySequence& good_sequence() {
  static const MemorySequence sequence = [] {
    std::vector<RgbdFrame> frames;
    for (int v = 0; v < 8; ++v) frames.push_back(render_view(swinging_camera(v), 0.0015, v + 1));
    return MemorySequence(std::move(frames));
  }();
  return sequence;
}

inline std::string names_of(const std::vector<Finding>& findings) {
  std::string names;
  for (const Finding& f : findings) names += f.fault + ": " + f.message + "; ";
  return names;
}

}  // namespace resight::test
