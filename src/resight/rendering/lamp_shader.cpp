// SPDX-License-Identifier: Apache-2.0
#include "resight/rendering/internal/lamp_shader.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace resight {
namespace {

// A well-mixed 32-bit hash (Wang), as a share of 1.
float hashed_share(std::uint32_t x) {
  x = (x ^ 61U) ^ (x >> 16U);
  x *= 9U;
  x ^= x >> 4U;
  x *= 0x27D4EB2DU;
  x ^= x >> 15U;
  return static_cast<float>(x >> 8U) * 0x1p-24F;
}

}  // namespace

// A point of the disc that the lamp shows. The samples of a pixel share its area, which makes penumbras smooth.
Eigen::Vector3f LampShader::point_of(const Lamp& lamp, std::uint32_t lamp_index, const LightSample& sample,
                                     const Eigen::Vector3f& from) {
  Eigen::Vector3f center = lamp.position_in_world_m.cast<float>();
  if (lamp.radius_m <= 0) return center;
  const std::uint32_t key = (sample.pixel * 8U + lamp_index) * 2U;
  const float area = (static_cast<float>(sample.index) + hashed_share(key)) / static_cast<float>(sample.count);
  const float angle =
      2 * std::numbers::pi_v<float> * (hashed_share(key + 1U) + 0.618F * static_cast<float>(sample.index));
  const Eigen::Vector3f axis = (center - from).normalized();
  const Eigen::Vector3f right = axis.unitOrthogonal();
  const float radius = static_cast<float>(lamp.radius_m) * std::sqrt(area);
  return center + radius * (std::cos(angle) * right + std::sin(angle) * axis.cross(right));
}

Eigen::Vector3f LampShader::shade(const SurfacePoint& point, const Eigen::Vector3f& color, float white,
                                  const SurfaceMaterial& material, const LightSample& sample) const {
  Eigen::Vector3f diffuse = static_cast<float>(lighting_.ambient) * (0.85F + 0.15F * point.normal.z()) *
                            lighting_.ambient_color.cast<float>();
  Eigen::Vector3f highlight = Eigen::Vector3f::Zero();
  for (std::uint32_t i = 0; i < lighting_.lamps.size(); ++i) {
    const Lamp& lamp = lighting_.lamps[i];
    Eigen::Vector3f to_lamp = point_of(lamp, i, sample, point.position) - point.position;
    const float distance = to_lamp.norm();
    to_lamp /= distance;
    const float cosine = point.normal.dot(to_lamp);
    if (cosine <= 0) continue;
    if (lighting_.shadows &&
        scene_.is_blocked({point.position, to_lamp}, kLampShadowGap_m, distance - kLampShadowGap_m))
      continue;
    diffuse += cosine * lamp.intensity.cast<float>();
    if (material.specular <= 0) continue;
    const float half = point.normal.dot((to_lamp + point.to_viewer).normalized());
    highlight += static_cast<float>(material.specular) *
                 std::pow(std::max(0.0F, half), static_cast<float>(material.shininess)) * lamp.intensity.cast<float>();
  }
  return color.cwiseProduct(diffuse) + white * highlight;
}

}  // namespace resight
