// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <cmath>

#include "resight/appearance/lab_color.hpp"

namespace resight {

/// A point of a surface; `normal`: unit.
struct SurfacePoint {
  Eigen::Vector3f position;
  Eigen::Vector3f normal;
};

/// Whether a surface continues from one point to another: near its tangent plane, with a similar normal. False for NaN.
[[nodiscard]] inline bool continues_shape(const SurfacePoint& from, const SurfacePoint& to, float max_offset_m) {
  constexpr float kMinNormalDot = 0.9F;  // 26 deg: more is an edge.
  return std::abs(from.normal.dot(to.position - from.position)) <= max_offset_m &&
         from.normal.dot(to.normal) >= kMinNormalDot;
}

/// Whether it continues in colour. Both points are seen by one camera in one light, so that the tolerance is that of
/// shading and noise, whatever the colour. False for NaN.
[[nodiscard]] inline bool continues_color(const LabColor& from, const LabColor& to) {
  constexpr float kMaxLightness = 0.375F;    // 19 of L*
  constexpr float kMaxChromaticity = 0.16F;  // 20 of a*, b*
  const float dl = (from.l - to.l) / kMaxLightness;
  const float da = (from.a - to.a) / kMaxChromaticity;
  const float db = (from.b - to.b) / kMaxChromaticity;
  return dl * dl + da * da + db * db < 1;
}

/// Extent of the largest face of an object relative to its diameter: noise may let it seem larger.
inline constexpr float kMaxFaceShare = 1.2F;

/// Whether a plane is larger than an object: a smaller one may be a face of the object itself.
[[nodiscard]] inline bool is_larger_than_object(float plane_extent_m, float object_diameter_m) {
  return plane_extent_m > kMaxFaceShare * object_diameter_m;
}

/// How much texture that an object shares with a surface speaks against the surface being a part of something larger,
/// such as a table: 0 without such texture, near 1 for much more than `scale`. Faces of boxes in a row lie in one
/// plane.
[[nodiscard]] inline double weigh_shared_texture(double shared_texture, double scale) {
  const double t = shared_texture / scale;
  return 1 - 1 / (1 + t * t);
}

}  // namespace resight
