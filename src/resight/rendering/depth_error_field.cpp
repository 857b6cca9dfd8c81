// SPDX-License-Identifier: Apache-2.0
#include "resight/rendering/internal/depth_error_field.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "resight/core/random.hpp"
#include "resight/rendering/internal/depth_edges.hpp"

namespace resight {
namespace {

constexpr std::uint64_t kErrorStream = 0xDE97AULL;  // separates these numbers from those of independent noise

// Distance to the nearest marked pixel by two passes over the image (chamfer distance).
Image<float> edge_distances(const Image<float>& depth_m) {
  const int w = depth_m.width();
  const int h = depth_m.height();
  Image<float> distance(w, h, std::numeric_limits<float>::infinity());
  for (int v = 0; v < h; ++v)
    for (int u = 0; u < w; ++u)
      if (!std::isnan(depth_m(u, v)) && is_beside_depth_edge(depth_m, u, v)) distance(u, v) = 0;
  const auto relax = [&](int u, int v, int du, int dv) {
    if (!distance.contains(u + du, v + dv)) return;
    const float step = du != 0 && dv != 0 ? std::numbers::sqrt2_v<float> : 1.0F;
    distance(u, v) = std::min(distance(u, v), distance(u + du, v + dv) + step);
  };
  for (int v = 0; v < h; ++v)
    for (int u = 0; u < w; ++u)
      for (const auto& [du, dv] : {std::pair{-1, 0}, {-1, -1}, {0, -1}, {1, -1}}) relax(u, v, du, dv);
  for (int v = h - 1; v >= 0; --v)
    for (int u = w - 1; u >= 0; --u)
      for (const auto& [du, dv] : {std::pair{1, 0}, {1, 1}, {0, 1}, {-1, 1}}) relax(u, v, du, dv);
  return distance;
}

}  // namespace

DepthErrorField::DepthErrorField(const DepthErrors& options, const Camera& camera, const RenderedView& view,
                                 std::uint64_t seed)
    : options_(options), camera_(camera) {
  Rng rng = Rng::stream(seed, kErrorStream);
  const auto field = [&](double cell_px) { return SmoothNoise(camera.width, camera.height, cell_px, rng.next()); };
  disparity_ = field(options.disparity_noise_cell_px);
  outline_u_ = field(options.outline_noise_cell_px);
  outline_v_ = field(options.outline_noise_cell_px);
  holes_ = field(options.hole_cell_px);
  if (options.edge_band_px > 0) edge_distance_px_ = edge_distances(view.depth_m);
}

Eigen::Vector2d DepthErrorField::measured_pixel(int u, int v) const {
  Eigen::Vector2d pixel = ideal_pixel(options_.lens, camera_, u - options_.shift_u_px, v - options_.shift_v_px);
  if (options_.outline_noise_px > 0)
    pixel += options_.outline_noise_px * Eigen::Vector2d(outline_u_.at(u, v), outline_v_.at(u, v));
  return pixel;
}

double DepthErrorField::disparity_error_px(int u, int v) const {
  return options_.disparity_offset_px + options_.disparity_noise_px * disparity_.at(u, v);
}

double DepthErrorField::loss_at_edge(const Pixel& measured) const {
  if (edge_distance_px_.empty()) return 0;
  const double distance_px = edge_distance_px_(measured.u, measured.v);
  return options_.edge_loss * std::max(0.0, 1 - distance_px / options_.edge_band_px);
}

double DepthErrorField::loss_of_surface(const SensedSurface& surface, double max_incidence_deg) const {
  double returned = surface.material.depth_return;
  if (surface.incidence_deg > options_.grazing_start_deg)
    returned *= std::max(0.0, (max_incidence_deg - surface.incidence_deg) /
                                  std::max(1e-9, max_incidence_deg - options_.grazing_start_deg));
  if (surface.brightness < options_.dark_level)
    returned *= 1 - options_.dark_loss * (1 - surface.brightness / options_.dark_level);
  if (surface.material.specular > 0) {
    // The projector is beside the camera, so its highlight is where the surface faces the camera.
    const double cosine = std::cos(surface.incidence_deg * std::numbers::pi / 180);
    const double highlight = surface.material.specular * std::pow(cosine, surface.material.shininess);
    returned *= 1 - std::min(1.0, options_.highlight_loss * highlight);
  }
  return 1 - returned;
}

bool DepthErrorField::is_lost(int u, int v, const Pixel& measured, const SensedSurface& surface,
                              double max_incidence_deg) const {
  const double loss = 1 - (1 - loss_at_edge(measured)) * (1 - loss_of_surface(surface, max_incidence_deg));
  return loss > 0 && normal_share_below(holes_.at(u, v)) < loss;
}

}  // namespace resight
