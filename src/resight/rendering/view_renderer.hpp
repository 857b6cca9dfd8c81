// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <vector>

#include "resight/core/image.hpp"
#include "resight/geometry/camera.hpp"
#include "resight/geometry/rigid3.hpp"
#include "resight/rendering/raycast_scene.hpp"
#include "resight/rendering/residual_distortion.hpp"

namespace resight {

/// A coloured lamp, which makes highlights on glossy surfaces.
struct Lamp {
  Eigen::Vector3d position_in_world_m = Eigen::Vector3d(1.2, -1.0, 2.8);
  Eigen::Vector3d intensity = Eigen::Vector3d::Constant(0.5);  ///< Red, green, blue; 1 lights a white surface fully.
  double radius_m = 0;                                         ///< Of the shining sphere: shadows have edges this soft.
};

/// One white lamp and ambient light that is slightly stronger from above, or several coloured lamps. Intensities are
/// relative to the surface colour.
struct Lighting {
  Eigen::Vector3d lamp_in_world_m = Eigen::Vector3d(1.2, -1.0, 2.8);
  double ambient = 0.55;
  double diffuse = 0.55;
  bool shadows = false;     ///< Whether lamps cast shadows; costs one ray per sample and lamp.
  std::vector<Lamp> lamps;  ///< Instead of the white lamp, if there are any.
  Eigen::Vector3d ambient_color = Eigen::Vector3d::Ones();  ///< Factors on `ambient`; only with `lamps`.
  void check() const;
};

struct RenderOptions {
  int samples_per_side = 2;  ///< Colour is averaged over n x n rays a pixel; depth, label and normal are of its centre.
  Lighting lighting;
  Rgb8 background{120, 122, 125};  ///< Where no surface is.
  /// Light adds up in linear intensities, as in a scene, instead of in encoded grey levels. Also fills
  /// RenderedView::light.
  bool linear_light = false;
  ResidualDistortion color_lens = {};  ///< Of the colour image only.
  int num_threads = 1;                 ///< Same bytes for any value >= 1.
  void check() const;
};

/// An ideal view. All images are registered pixel by pixel.
struct RenderedView {
  Image<Rgb8> color;
  Image<float> depth_m;  ///< Along z; NaN if there is no surface.
  Image<int> labels;     ///< Instance in the scene; -1 if there is no surface.
  /// Unit normal of the face, oriented towards the camera; NaN if there is no surface.
  Image<Eigen::Vector3f> normals_in_camera;
  Image<Eigen::Vector3f> light;  ///< Linear, 1 = white surface in full light, not clipped; empty unless asked for.
};

/// Ray-casts the visible instances of a committed scene. Pixel centres are at whole numbers; there is no distortion but
/// that of options.color_lens. Throws std::invalid_argument for an invalid camera or pose.
[[nodiscard]] RenderedView render_scene(const RaycastScene& scene, const Camera& camera,
                                        const Rigid3& world_from_camera, const RenderOptions& options = {});

/// Ray through pixel (u, v), which may lie between pixel centres. Its direction has z = 1 in the camera frame, so that
/// distances along it are depths.
[[nodiscard]] Ray pixel_ray(const Camera& camera, const Rigid3f& world_from_camera, float u, float v);

/// Pose of a camera at `eye` that looks at `target`, with +z of the world (or `up`) upwards in the image. Throws
/// std::invalid_argument if eye and target coincide or lie along `up`.
[[nodiscard]] Rigid3 look_at(const Eigen::Vector3d& eye, const Eigen::Vector3d& target,
                             const Eigen::Vector3d& up = Eigen::Vector3d::UnitZ());

}  // namespace resight
