// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <optional>

#include "resight/rendering/color_camera.hpp"
#include "resight/rendering/depth_errors.hpp"
#include "resight/rendering/view_renderer.hpp"

namespace resight {

/// A structured-light camera (Kinect v1 and similar). Each effect can be switched off separately.
struct SensorOptions {
  bool noise_free = false;           ///< Exact depth and colour, whatever the fields below say (even the range).
  double lateral_noise = 1.0;        ///< Factor on Nguyen's lateral sigma; the ray of each pixel is perturbed. 0 = off.
  double axial_noise = 1.0;          ///< Factor on Nguyen's axial sigma. 0 = off.
  double disparity_step_px = 0.125;  ///< Kinect: 1/8 px. 0 = depth is not quantised.
  double baseline_m = 0.075;         ///< Camera to projector, along the camera's +x (Kinect: 7.5 cm).
  bool projector_shadow = true;      ///< No return where the projector does not see the surface.
  /// No return from surfaces slanted more; returns thin out over the 10 deg before. 90 = off.
  double max_incidence_deg = 82.0;
  double edge_dropout = 0.4;          ///< Probability of no return beside a depth discontinuity. 0 = off.
  double min_depth_m = 0.5;           ///< Nearer: no return.
  double max_depth_m = 4.0;           ///< Farther: no return.
  double color_noise = 2.0;           ///< Sigma of each channel of each pixel, of 255. 0 = off.
  double gain_sigma = 0.05;           ///< Relative sigma of the exposure from view to view, up to 2. 0 = off.
  double white_balance_sigma = 0.01;  ///< Relative sigma of each channel from view to view, up to 2. 0 = off.
  std::optional<DepthErrors> depth_errors = {};  ///< Correlated and systematic errors of depth.
  /// Image processing of the colour camera. Replaces color_noise, and needs linear light.
  std::optional<ColorCamera> color_camera = {};
  void check() const;
};

/// Simulates the depth image of the sensor in metres (NaN = no return). `view` must be rendered from the same scene,
/// camera and pose. Throws std::invalid_argument if the size of the view differs from that of the camera image.
[[nodiscard]] Image<float> sense_depth(const RaycastScene& scene, const Camera& camera, const Rigid3& world_from_camera,
                                       const RenderedView& view, const SensorOptions& options, std::uint64_t seed,
                                       int num_threads = 1);

/// Simulates the colour image of the sensor from an ideal image: gain, white balance and pixel noise.
[[nodiscard]] Image<Rgb8> sense_color(const Image<Rgb8>& ideal, const SensorOptions& options, std::uint64_t seed,
                                      int num_threads = 1);

/// Same for a view that was rendered with RenderOptions::linear_light if options.color_camera is set. Throws
/// std::invalid_argument if it was not.
[[nodiscard]] Image<Rgb8> sense_color(const RenderedView& view, const SensorOptions& options, std::uint64_t seed,
                                      int num_threads = 1);

/// Depth whose disparity is the nearest multiple of the step. `focal_baseline` is focal length (px) times baseline (m).
[[nodiscard]] double quantize_depth(double depth_m, double focal_baseline, double disparity_step_px);

}  // namespace resight
