// SPDX-License-Identifier: Apache-2.0
#include "resight/sensor/rectify.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace resight {
namespace {

constexpr float kNoReturn = std::numeric_limits<float>::quiet_NaN();

/// The position in the distorted image that shows pixel (u, v) of the ideal one.
std::optional<Eigen::Vector2d> source_of(int u, int v, const Camera& camera, const LensDistortion& lens) {
  const auto bent = lens.distort({(u - camera.cx) / camera.fx, (v - camera.cy) / camera.fy});
  if (!bent) return std::nullopt;
  return Eigen::Vector2d(camera.fx * bent->x() + camera.cx, camera.fy * bent->y() + camera.cy);
}

Rgb8 interpolate_color(const Image<Rgb8>& color, const Eigen::Vector2d& position_px) {
  const double x = std::clamp(position_px.x(), 0.0, color.width() - 1.0);
  const double y = std::clamp(position_px.y(), 0.0, color.height() - 1.0);
  const int u = std::min(static_cast<int>(x), std::max(color.width() - 2, 0));
  const int v = std::min(static_cast<int>(y), std::max(color.height() - 2, 0));
  const int right = std::min(u + 1, color.width() - 1);
  const int below = std::min(v + 1, color.height() - 1);
  const double a = x - u;
  const double b = y - v;
  const auto mix = [&](std::uint8_t Rgb8::*channel) {
    const double top = (1 - a) * color(u, v).*channel + a * color(right, v).*channel;
    const double bottom = (1 - a) * color(u, below).*channel + a * color(right, below).*channel;
    return static_cast<std::uint8_t>(std::lround((1 - b) * top + b * bottom));
  };
  return {mix(&Rgb8::r), mix(&Rgb8::g), mix(&Rgb8::b)};
}

/// Pixels that one depth pixel covers in the colour image.
struct CoveredPixels {
  int left = 0, top = 0, right = -1, bottom = -1;
};

/// Largest side of the covered pixels: a colour image of at most 16 times the resolution of depth.
constexpr double kMaxCovered_px = 16;

CoveredPixels cover(const Eigen::Vector2d& first, const Eigen::Vector2d& last, const Camera& camera) {
  const Eigen::Vector2d low = first.cwiseMin(last);
  const Eigen::Vector2d high = first.cwiseMax(last);
  const bool inside = low.x() < camera.width && low.y() < camera.height && high.x() > -1 && high.y() > -1;
  if (!inside || !((high - low).maxCoeff() <= kMaxCovered_px)) return {};
  return {std::max(0, static_cast<int>(std::ceil(low.x()))), std::max(0, static_cast<int>(std::ceil(low.y()))),
          std::min(camera.width - 1, static_cast<int>(std::floor(high.x()))),
          std::min(camera.height - 1, static_cast<int>(std::floor(high.y())))};
}

}  // namespace

Image<Rgb8> undistort_color(const Image<Rgb8>& color, const Camera& camera, const LensDistortion& lens) {
  if (lens.is_none()) return color;
  Image<Rgb8> ideal(color.width(), color.height());
  for (int v = 0; v < color.height(); ++v)
    for (int u = 0; u < color.width(); ++u)
      if (const auto position_px = source_of(u, v, camera, lens); position_px && camera.contains(*position_px))
        ideal(u, v) = interpolate_color(color, *position_px);
  return ideal;
}

Image<float> undistort_depth(const Image<float>& depth_m, const Camera& camera, const LensDistortion& lens) {
  if (lens.is_none()) return depth_m;
  Image<float> ideal(depth_m.width(), depth_m.height(), kNoReturn);
  for (int v = 0; v < depth_m.height(); ++v)
    for (int u = 0; u < depth_m.width(); ++u)
      if (const auto position_px = source_of(u, v, camera, lens))
        if (const auto pixel = camera.pixel_at(*position_px)) ideal(u, v) = depth_m(pixel->u, pixel->v);
  return ideal;
}

Image<float> register_depth(const Image<float>& depth_m, const Camera& depth_camera, const Rigid3& color_from_depth,
                            const Camera& color_camera) {
  Image<float> registered(color_camera.width, color_camera.height, kNoReturn);
  for (int v = 0; v < depth_m.height(); ++v)
    for (int u = 0; u < depth_m.width(); ++u) {
      const float z = depth_m(u, v);
      if (std::isnan(z)) continue;
      const Eigen::Vector3d first = color_from_depth * depth_camera.unproject(u - 0.5, v - 0.5, z);
      const Eigen::Vector3d last = color_from_depth * depth_camera.unproject(u + 0.5, v + 0.5, z);
      const double depth_there_m = (color_from_depth * depth_camera.unproject(u, v, z)).z();
      if (!(first.z() > 0 && last.z() > 0 && depth_there_m > 0)) continue;
      const CoveredPixels covered = cover(color_camera.project(first), color_camera.project(last), color_camera);
      for (int y = covered.top; y <= covered.bottom; ++y)
        for (int x = covered.left; x <= covered.right; ++x)
          if (float& pixel = registered(x, y); !(pixel <= depth_there_m)) pixel = static_cast<float>(depth_there_m);
    }
  return registered;
}

}  // namespace resight
