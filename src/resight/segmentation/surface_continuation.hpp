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

/// Whether it continues in colour.
[[nodiscard]] inline bool continues_color(const LabColor& from, const LabColor& to, const ColorTolerance& tolerance) {
  constexpr float kMaxExponent = 0.22F;  // A similarity of 0.8.
  return tolerance.exponent(from, to) < kMaxExponent;
}

/// Whether a plane is larger than an object: a smaller one may be a face of the object itself.
[[nodiscard]] inline bool is_larger_than_object(float plane_extent_m, float object_diameter_m) {
  constexpr float kFactor = 1.2F;  // A face of the object may seem larger by noise.
  return plane_extent_m > kFactor * object_diameter_m;
}

}  // namespace resight
