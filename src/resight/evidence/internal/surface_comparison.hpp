// SPDX-License-Identifier: Apache-2.0
// The surfaces that one view measured, compared with what another view measured where they project to.
#pragma once
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

#include "resight/evidence/surface_evidence.hpp"
#include "resight/sensor/prepared_view.hpp"

namespace resight {

/// A measured surface in front of the other camera.
struct SurfaceInView {
  float z_m;       ///< In that camera.
  float slope;     ///< Distance along the normal per metre along z.
  float variance;  ///< Of the distance along the normal; m^2.
  int u, v;        ///< Pixel that shows it; -1: none, or at too grazing an angle.

  [[nodiscard]] bool is_visible() const { return u >= 0; }
};

/// From surfaces in one camera's frame to the pixels of another camera.
struct Reprojection {
  Reprojection(const Rigid3& transform, const Camera& camera)
      : view_from_surfaces(transform),
        fx(static_cast<float>(camera.fx)),
        fy(static_cast<float>(camera.fy)),
        left_px(static_cast<float>(camera.cx + 0.5)),
        top_px(static_cast<float>(camera.cy + 0.5)),
        width_px(static_cast<float>(camera.width)),
        height_px(static_cast<float>(camera.height)) {}

  Rigid3f view_from_surfaces;
  float fx, fy;
  float left_px, top_px;  ///< From the corner of the image to the principal point.
  float width_px, height_px;
};

/// Moves the surfaces of `num` pixels into the other camera's frame. No output may overlap another array.
void reproject(const Reprojection& to, int num, const float* x, const float* y, const float* z, const float* nx,
               const float* ny, const float* nz, const float* sigma_m, float* out_z_m, float* out_slope,
               float* out_variance, int* out_u, int* out_v);

/// Surfaces of pixels in a row, as a structure of arrays.
struct PosedRow {
  explicit PosedRow(int num) : z_m(static_cast<std::size_t>(num)), slope(z_m), variance(z_m), u(z_m.size()), v(u) {}
  [[nodiscard]] SurfaceInView operator[](int column) const {
    const auto i = static_cast<std::size_t>(column);
    return {z_m[i], slope[i], variance[i], u[i], v[i]};
  }

  std::vector<float> z_m, slope, variance;
  std::vector<int> u, v;
};

/// Compares the surfaces of a view with the measurements of another view, which sees through those that lie more than
/// `sigmas` standard deviations before them. Both views must outlive it.
class SurfaceComparison {
 public:
  SurfaceComparison(const PreparedView& surfaces, const PreparedView& view, float sigmas)
      : surfaces_(surfaces),
        view_(view),
        reprojection_(view.frame.world_from_camera.inverse() * surfaces.frame.world_from_camera, view.frame.camera),
        sigmas_(sigmas) {}

  [[nodiscard]] SurfaceInView pose(std::size_t i) const {
    SurfaceInView s{};
    reproject_from(i, 1, &s.z_m, &s.slope, &s.variance, &s.u, &s.v);
    return s;
  }

  void pose_row(int row, PosedRow& posed) const {
    reproject_from(surfaces_.cloud.z.index(0, row), surfaces_.cloud.width(), posed.z_m.data(), posed.slope.data(),
                   posed.variance.data(), posed.u.data(), posed.v.data());
  }
  [[nodiscard]] int index(const SurfaceInView& surface) const {
    return surface.is_visible() ? static_cast<int>(view_.frame.depth_m.index(surface.u, surface.v)) : -1;
  }
  [[nodiscard]] Evidence classify(const SurfaceInView& surface, int radius_px) const {
    if (!surface.is_visible()) return Evidence::kUnobserved;
    const Evidence center = compare(surface, view_.frame.depth_m.index(surface.u, surface.v));
    if (center == Evidence::kPresent) return center;
    return agree_in_window(surface, radius_px, center);
  }

  /// The smallest window around the pixel that the surface projects to with a measurement that agrees with it, in rows
  /// and columns on each side. 0: the measurement of the pixel itself agrees. Nothing if none within the largest does,
  /// or if the pixel has no measurement.
  [[nodiscard]] std::optional<int> find_agreeing_radius(std::size_t i, int max_radius_px) const {
    const SurfaceInView surface = pose(i);
    if (!surface.is_visible() || std::isnan(view_.frame.depth_m(surface.u, surface.v))) return std::nullopt;
    for (int radius_px = 0; radius_px <= max_radius_px; ++radius_px)
      if (agrees_on_ring(surface, radius_px)) return radius_px;
    return std::nullopt;
  }

  /// Distance of the surface to the measurement where it projects to, in standard deviations; NaN if there is none.
  [[nodiscard]] float normalized_distance(const SurfaceInView& surface, float max_distance_m) const {
    if (!surface.is_visible()) return kNaN;
    const std::size_t j = view_.frame.depth_m.index(surface.u, surface.v);
    const float behind_m = distance_m(surface, j);
    return std::abs(behind_m) < max_distance_m ? behind_m / sigma_m(surface, j) : kNaN;
  }

 private:
  static constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();

  void reproject_from(std::size_t first, int num, float* z_m, float* slope, float* variance, int* u, int* v) const {
    const OrganizedCloud& c = surfaces_.cloud;
    reproject(reprojection_, num, &c.x[first], &c.y[first], &c.z[first], &c.nx[first], &c.ny[first], &c.nz[first],
              &surfaces_.noise.normal_m[first], z_m, slope, variance, u, v);
  }
  /// How far the measurement lies behind the surface, along its normal.
  [[nodiscard]] float distance_m(const SurfaceInView& surface, std::size_t j) const {
    return (view_.frame.depth_m[j] - surface.z_m) * surface.slope;
  }
  [[nodiscard]] float sigma_m(const SurfaceInView& surface, std::size_t j) const {
    const float of_view_m = view_.noise.normal_m[j];
    // Beyond prepare.max_depth_m there is depth, but no noise. Such a measurement is far behind.
    return std::sqrt(surface.variance + (std::isnan(of_view_m) ? 0.0F : of_view_m * of_view_m));
  }
  /// Along the normal.
  [[nodiscard]] Evidence compare(const SurfaceInView& surface, std::size_t j) const {
    return compare_depth(0, distance_m(surface, j), sigmas_ * sigma_m(surface, j));
  }

  /// Whether a measurement at this Chebyshev distance from the pixel agrees with the surface.
  [[nodiscard]] bool agrees_on_ring(const SurfaceInView& surface, int radius_px) const {
    const Pixel center{surface.u, surface.v};
    const Image<float>& depth_m = view_.frame.depth_m;
    const auto agrees_at = [&](int u, int v) {
      return u >= 0 && v >= 0 && u < depth_m.width() && v < depth_m.height() &&
             compare(surface, depth_m.index(u, v)) == Evidence::kPresent;
    };
    if (radius_px == 0) return agrees_at(center.u, center.v);
    for (int step = -radius_px; step < radius_px; ++step)  // each corner once
      if (agrees_at(center.u + step, center.v - radius_px) || agrees_at(center.u + radius_px, center.v + step) ||
          agrees_at(center.u - step, center.v + radius_px) || agrees_at(center.u - radius_px, center.v - step))
        return true;
    return false;
  }

  /// The evidence of the pixel if no neighbour explains or contradicts it.
  [[nodiscard]] Evidence agree_in_window(const SurfaceInView& surface, int radius_px, Evidence evidence) const {
    const Pixel center{surface.u, surface.v};
    const Image<float>& depth_m = view_.frame.depth_m;
    bool agrees = true;
    for (int v = std::max(center.v - radius_px, 0); v <= std::min(center.v + radius_px, depth_m.height() - 1); ++v)
      for (int u = std::max(center.u - radius_px, 0); u <= std::min(center.u + radius_px, depth_m.width() - 1); ++u) {
        const Evidence neighbor = compare(surface, depth_m.index(u, v));
        if (neighbor == Evidence::kPresent) return neighbor;
        agrees &= neighbor == evidence || neighbor == Evidence::kUnobserved;
      }
    return agrees ? evidence : Evidence::kUnobserved;
  }

  const PreparedView& surfaces_;
  const PreparedView& view_;
  Reprojection reprojection_;
  float sigmas_;
};

}  // namespace resight
