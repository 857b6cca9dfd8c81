// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <cstdint>

#include "resight/rendering/view_renderer.hpp"

namespace resight {

inline constexpr float kLampShadowGap_m = 1e-3F;  ///< Closer surfaces cast no shadow, which prevents self-shadowing.

/// A point of a surface in the world frame. Both directions are unit vectors.
struct SurfacePoint {
  Eigen::Vector3f position;
  Eigen::Vector3f normal;
  Eigen::Vector3f to_viewer;
};

/// Which sample of which pixel is shaded. The samples of a pixel see different points of a large lamp.
struct LightSample {
  std::uint32_t pixel = 0;
  int index = 0;
  int count = 1;
};

/// Light of coloured lamps: diffuse reflection, cast shadows, and highlights by Blinn's model.
class LampShader {
 public:
  LampShader(const RaycastScene& scene, const Lighting& lighting) : scene_(scene), lighting_(lighting) {}

  /// Reflected light. `white` is the value of a white surface in full light.
  [[nodiscard]] Eigen::Vector3f shade(const SurfacePoint& point, const Eigen::Vector3f& color, float white,
                                      const SurfaceMaterial& material, const LightSample& sample) const;

 private:
  [[nodiscard]] static Eigen::Vector3f point_of(const Lamp& lamp, std::uint32_t lamp_index, const LightSample& sample,
                                                const Eigen::Vector3f& from);
  const RaycastScene& scene_;
  const Lighting& lighting_;
};

}  // namespace resight
