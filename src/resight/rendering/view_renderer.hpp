// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>

#include "resight/core/image.hpp"
#include "resight/geometry/camera.hpp"
#include "resight/geometry/rigid3.hpp"
#include "resight/rendering/raycast_scene.hpp"

namespace resight {

/// One lamp and a soft light from everywhere, a little more of it from above. Shares of the surface's own colour.
struct Lighting {
  Eigen::Vector3d lamp_in_world_m = Eigen::Vector3d(1.2, -1.0, 2.8);
  double ambient = 0.55;
  double diffuse = 0.55;
  bool shadows = false;  ///< Cast by the lamp; costs a ray a sample.
  void check() const;
};

struct RenderOptions {
  int samples_per_side = 2;  ///< Colour is averaged over n x n rays a pixel; depth, label and normal are of its centre.
  Lighting lighting;
  Rgb8 background{120, 122, 125};  ///< Where no surface is.
  int num_threads = 1;             ///< Same bytes for any value >= 1.
  void check() const;
};

/// What an ideal camera sees, registered pixel by pixel.
struct RenderedView {
  Image<Rgb8> color;
  Image<float> depth_m;                      ///< Along z; NaN = no surface.
  Image<int> labels;                         ///< Instance in the scene; -1 = no surface.
  Image<Eigen::Vector3f> normals_in_camera;  ///< Of the face, unit, turned to the camera; NaN = no surface.
};

/// Ray-casts the visible instances of a committed scene. Pixel centres at whole numbers, no distortion.
[[nodiscard]] RenderedView render_scene(const RaycastScene& scene, const Camera& camera,
                                        const Rigid3& world_from_camera, const RenderOptions& options = {});

/// Ray through pixel (u, v), which may lie between pixel centres; its direction has z = 1 in the camera frame, so that
/// distances along it are depths.
[[nodiscard]] Ray pixel_ray(const Camera& camera, const Rigid3f& world_from_camera, float u, float v);

/// A camera at `eye` that looks at `target`, with world +z (or `up`) upwards in the image. The directions must differ.
[[nodiscard]] Rigid3 look_at(const Eigen::Vector3d& eye, const Eigen::Vector3d& target,
                             const Eigen::Vector3d& up = Eigen::Vector3d::UnitZ());

}  // namespace resight
