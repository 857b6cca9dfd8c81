// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "resight/core/random.hpp"
#include "resight/sensor/rgbd_frame.hpp"

/// Analytic depth images for tests.
namespace resight::test {

inline constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

inline Camera small_camera() { return {150, 110, 130.0, 128.0, 73.2, 55.7}; }

/// Depth of the plane n.p = d; NaN where the ray does not meet it in front of the camera.
inline Image<float> render_plane(const Camera& camera, const Eigen::Vector3d& normal, double distance_m) {
  Image<float> depth(camera.width, camera.height, kNan);
  for (int v = 0; v < camera.height; ++v)
    for (int u = 0; u < camera.width; ++u) {
      const double z = distance_m / normal.dot(camera.unproject(u, v, 1));
      if (z > 0 && z < 20) depth(u, v) = static_cast<float>(z);
    }
  return depth;
}

/// Depth of a sphere in front of a wall at `wall_m`.
inline Image<float> render_sphere(const Camera& camera, const Eigen::Vector3d& center, double radius_m, double wall_m) {
  Image<float> depth(camera.width, camera.height, static_cast<float>(wall_m));
  for (int v = 0; v < camera.height; ++v)
    for (int u = 0; u < camera.width; ++u) {
      const Eigen::Vector3d ray = camera.unproject(u, v, 1);
      const double a = ray.squaredNorm();
      const double b = ray.dot(center);
      const double root = b * b - a * (center.squaredNorm() - radius_m * radius_m);
      if (root > 0) depth(u, v) = static_cast<float>((b - std::sqrt(root)) / a);
    }
  return depth;
}

/// The sphere scene with noise proportional to depth and with scattered holes.
inline Image<float> render_noisy_sphere(const Camera& camera, std::uint64_t seed, double noise_share = 0.001) {
  Image<float> depth = render_sphere(camera, {0.05, 0.02, 1.0}, 0.25, 1.6);
  Rng rng(seed);
  for (float& z : depth.data()) {
    z += static_cast<float>(noise_share * rng.normal()) * z;
    if (rng.uniform() < 0.03) z = kNan;
  }
  return depth;
}

inline RgbdFrame make_frame(const Camera& camera, Image<float> depth_m) {
  RgbdFrame frame;
  frame.name = "test";
  frame.camera = camera;
  frame.color = Image<Rgb8>(camera.width, camera.height, Rgb8{128, 128, 128});
  frame.depth_m = std::move(depth_m);
  return frame;
}

/// Bytewise equality; NaN equals NaN.
inline bool same_bytes(const Image<float>& a, const Image<float>& b) {
  return a.width() == b.width() && a.height() == b.height() &&
         std::equal(a.data().begin(), a.data().end(), b.data().begin(), [](float p, float q) {
           return std::bit_cast<std::uint32_t>(p) == std::bit_cast<std::uint32_t>(q);
         });
}

}  // namespace resight::test
