// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>

#include "resight/rendering/depth_errors.hpp"
#include "resight/rendering/internal/smooth_noise.hpp"
#include "resight/rendering/view_renderer.hpp"

namespace resight {

/// What a ray of the depth camera met.
struct SensedSurface {
  double incidence_deg = 0;
  SurfaceMaterial material;
  double brightness = 1;  ///< Of the surface colour, as a share of white.
};

/// The errors of one depth image. All values are drawn at construction, so that rows can be sensed in any order.
class DepthErrorField {
 public:
  DepthErrorField(const DepthErrors& options, const Camera& camera, const RenderedView& view, std::uint64_t seed);

  /// The ideal pixel that pixel (u, v) measures.
  [[nodiscard]] Eigen::Vector2d measured_pixel(int u, int v) const;
  /// Error of the disparity at a pixel.
  [[nodiscard]] double disparity_error_px(int u, int v) const;
  /// Whether pixel (u, v), which measures the ideal pixel `measured`, has no return. `max_incidence_deg` is that of
  /// SensorOptions.
  [[nodiscard]] bool is_lost(int u, int v, const Pixel& measured, const SensedSurface& surface,
                             double max_incidence_deg) const;

 private:
  [[nodiscard]] double loss_at_edge(const Pixel& measured) const;
  [[nodiscard]] double loss_of_surface(const SensedSurface& surface, double max_incidence_deg) const;

  DepthErrors options_;
  const Camera& camera_;
  SmoothNoise disparity_, outline_u_, outline_v_, holes_;
  Image<float> edge_distance_px_;  // empty without edge_band_px
};

}  // namespace resight
