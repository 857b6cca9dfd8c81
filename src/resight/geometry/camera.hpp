// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <algorithm>
#include <optional>

#include "resight/geometry/depth_noise.hpp"

namespace resight {

/// Column and row of an image.
struct Pixel {
  int u = 0;
  int v = 0;
  friend bool operator==(const Pixel&, const Pixel&) = default;
};

/// A pinhole camera without distortion, and the noise of its depth. Pixel centres are at whole numbers. Camera frame: x
/// right, y down, z forward.
struct Camera {
  int width = 0;
  int height = 0;
  double fx = 0;  ///< px
  double fy = 0;  ///< px
  double cx = 0;  ///< px
  double cy = 0;  ///< px
  DepthNoise noise = {};

  /// Whether size and focal lengths are positive and all numbers are finite.
  [[nodiscard]] bool is_valid() const;
  /// Pixel (u, v) of a point with z > 0. The pixel may lie outside the image.
  [[nodiscard]] Eigen::Vector2d project(const Eigen::Vector3d& p_in_camera) const {
    return {fx * p_in_camera.x() / p_in_camera.z() + cx, fy * p_in_camera.y() / p_in_camera.z() + cy};
  }
  /// The point at `depth_m` (along z, not along the ray) on the ray of pixel (u, v).
  [[nodiscard]] Eigen::Vector3d unproject(double u, double v, double depth_m) const {
    return {(u - cx) / fx * depth_m, (v - cy) / fy * depth_m, depth_m};
  }
  /// Whether the pixel lies within the image, including borders of half a pixel around the outer pixel centres.
  [[nodiscard]] bool contains(const Eigen::Vector2d& pixel) const {
    return pixel.x() >= -0.5 && pixel.y() >= -0.5 && pixel.x() < width - 0.5 && pixel.y() < height - 0.5;
  }
  /// The pixel whose centre is nearest to a position in the image; none outside the image and for NaN.
  [[nodiscard]] std::optional<Pixel> pixel_at(const Eigen::Vector2d& position_px) const {
    if (!contains(position_px)) return std::nullopt;
    // Truncation rounds down: the sum is not negative. In an image of a few pixels it may round up to the size.
    return Pixel{std::min(static_cast<int>(position_px.x() + 0.5), width - 1),
                 std::min(static_cast<int>(position_px.y() + 0.5), height - 1)};
  }
  /// The pixel that shows a point; none for z <= 0, outside the image and for NaN.
  [[nodiscard]] std::optional<Pixel> pixel_of(const Eigen::Vector3d& p_in_camera) const {
    if (!(p_in_camera.z() > 0)) return std::nullopt;
    return pixel_at(project(p_in_camera));
  }
  friend bool operator==(const Camera&, const Camera&) = default;
};

/// The usual intrinsics of Kinect v1 and Xtion: 640x480, f = 525 px, centre (319.5, 239.5).
[[nodiscard]] Camera make_kinect_camera();

}  // namespace resight
