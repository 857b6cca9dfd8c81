// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "resight/core/image.hpp"
#include "resight/core/random.hpp"
#include "resight/geometry/camera.hpp"
#include "resight/geometry/rigid3.hpp"
#include "resight/sensor/rgbd_frame.hpp"

/// Analytic views for tests of cameras: a textured floor with a ball and a box wall, rendered from any pose.
namespace resight::test {

struct BallScene {
  Eigen::Vector3d ball_m = Eigen::Vector3d(0.1, 0.05, 0.12);
  double ball_radius_m = 0.12;
  bool has_ball = true;
  bool textured = true;
  bool ball_print = false;  ///< The texture of the ball moves with it.
};

inline Camera ball_scene_camera() { return {320, 240, 280.0, 280.0, 159.5, 119.5}; }

/// Pose of a camera at `eye` that looks at `target`. The z axis of the world points up.
inline Rigid3 look_at_point(const Eigen::Vector3d& eye, const Eigen::Vector3d& target) {
  const Eigen::Vector3d z = (target - eye).normalized();
  const Eigen::Vector3d x = z.cross(Eigen::Vector3d::UnitZ()).normalized();
  Rigid3 pose;
  pose.rotation << x, z.cross(x), z;
  pose.translation = eye;
  return pose;
}

inline Rgb8 texture_at(const Eigen::Vector3d& p, bool textured) {
  if (!textured) return {128, 128, 128};
  double shade = 0;
  // Frequencies without a common period, because a periodic pattern would match itself at several places.
  for (const double f : {11.3, 18.7, 29.9, 47.1})
    shade += std::sin(f * (p.x() + 0.3 * p.y() * p.y())) * std::sin(1.31 * f * p.y() + 5 * p.x()) +
             std::sin(1.17 * f * p.z() + 2 * p.x());
  const auto level = static_cast<std::uint8_t>(128 + std::clamp(25 * shade, -120.0, 120.0));
  return {level, level, level};
}

/// Renders the floor z = 0, the wall y = 0.8 and the ball. `noise_m` is the standard deviation of depth.
inline RgbdFrame render_ball_scene(const BallScene& scene, const Rigid3& world_from_camera, double noise_m = 0,
                                   std::uint64_t seed = 1) {
  RgbdFrame frame;
  frame.name = "ball";
  frame.camera = ball_scene_camera();
  frame.world_from_camera = world_from_camera;
  frame.color = Image<Rgb8>(frame.camera.width, frame.camera.height);
  frame.depth_m = Image<float>(frame.camera.width, frame.camera.height, std::numeric_limits<float>::quiet_NaN());
  Rng rng(seed);
  const Eigen::Vector3d eye = world_from_camera.translation;
  for (int v = 0; v < frame.camera.height; ++v)
    for (int u = 0; u < frame.camera.width; ++u) {
      const Eigen::Vector3d ray = world_from_camera.rotation * frame.camera.unproject(u, v, 1);
      double depth = std::numeric_limits<double>::infinity();
      if (ray.z() < 0) depth = -eye.z() / ray.z();
      if (ray.y() > 0) depth = std::min(depth, (0.8 - eye.y()) / ray.y());
      const Eigen::Vector3d offset = eye - scene.ball_m;
      const double a = ray.squaredNorm(), b = ray.dot(offset);
      const double root = b * b - a * (offset.squaredNorm() - scene.ball_radius_m * scene.ball_radius_m);
      if (scene.has_ball && root > 0 && -b - std::sqrt(root) > 0) depth = std::min(depth, (-b - std::sqrt(root)) / a);
      if (!std::isfinite(depth) || depth > 4) continue;
      const Eigen::Vector3d p = eye + depth * ray;
      const bool on_ball = scene.has_ball && (p - scene.ball_m).norm() < scene.ball_radius_m + 1e-6;
      frame.color(u, v) =
          texture_at(on_ball && scene.ball_print ? Eigen::Vector3d(4 * (p - scene.ball_m)) : p, scene.textured);
      frame.depth_m(u, v) = static_cast<float>(depth + noise_m * rng.normal());
    }
  return frame;
}

/// What a camera measures whose disparity is off by `bias_per_m`, with the noise of a Kinect (2.9 mm at 1.2 m):
/// 1 / measured = 1 / z + bias_per_m.
inline RgbdFrame render_biased_view(const BallScene& scene, const Rigid3& world_from_camera, double bias_per_m,
                                    std::uint64_t seed) {
  constexpr double kDisparityNoise_per_m = 2e-3;
  RgbdFrame frame = render_ball_scene(scene, world_from_camera);
  Rng rng(seed);
  for (std::size_t i = 0; i < frame.depth_m.size(); ++i)
    frame.depth_m[i] =
        static_cast<float>(1 / (1.0 / frame.depth_m[i] + bias_per_m + kDisparityNoise_per_m * rng.normal()));
  return frame;
}

/// Eight of them, by steps on a circle, whose poses are off by some millimetres. 0: the camera stands still.
inline std::vector<RgbdFrame> render_biased_views(double bias_per_m, const BallScene& scene = {},
                                                  double step_rad = 0.22) {
  std::vector<RgbdFrame> frames;
  Rng rng(7);
  for (int v = 0; v < 8; ++v) {
    const double angle_rad = -2.3 + step_rad * v;
    const double distance_m = 1.1 + (step_rad > 0 ? 0.25 * (v % 3) : 0);
    const Rigid3 pose =
        look_at_point({distance_m * std::cos(angle_rad), distance_m * std::sin(angle_rad), 0.75}, {0.05, 0.05, 0.1});
    frames.push_back(render_biased_view(scene, pose, bias_per_m, static_cast<std::uint64_t>(v) + 1));
    for (int axis = 0; axis < 3; ++axis) frames.back().world_from_camera.translation[axis] += 0.002 * rng.normal();
  }
  return frames;
}

/// Distances between `a` and `b`: translation in metres, rotation in radians.
inline double shift_m(const Rigid3& a, const Rigid3& b) { return (a.translation - b.translation).norm(); }
inline double turn_rad(const Rigid3& a, const Rigid3& b) { return rotation_angle_rad(a.rotation, b.rotation); }

}  // namespace resight::test
