// SPDX-License-Identifier: Apache-2.0
#include "resight/evidence/view_comparison.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "resight/core/check.hpp"
#include "resight/core/parallel.hpp"
#include "resight/core/statistics.hpp"
#include "resight/evidence/color_change.hpp"
#include "resight/sensor/occluding_contour.hpp"

namespace resight {
namespace {

constexpr std::size_t kComparedRows = 8;
constexpr int kScaleStep_px = 4;               // One pixel in 16 is enough for a median.
constexpr std::size_t kMinScaleSamples = 500;  // With fewer, the median says little.
constexpr float kMaxScaleDistance_m = 0.1F;    // Larger differences are other surfaces.
constexpr float kMinViewingCosine = 0.05F;     // 87 deg: at more grazing angles depth says nothing about a surface.
// Depth is quantised: the median of small differences may be 0, though the noise is not.
constexpr double kMinNoiseScale = 0.7;
constexpr int kMaxMisregistration_px = 8;  // Beyond, other surfaces agree by chance.
constexpr double kExplainedShare = 0.9;    // The rest agree by chance.
constexpr int kMinContourPixels = 25;      // With fewer, the share says little.

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

/// Passes pointers as parameters, because compilers honour __restrict only there; otherwise the loop is not vectorised.
void reproject(const Reprojection& to, int num, const float* __restrict x, const float* __restrict y,
               const float* __restrict z, const float* __restrict nx, const float* __restrict ny,
               const float* __restrict nz, const float* __restrict sigma_m, float* __restrict out_z_m,
               float* __restrict out_slope, float* __restrict out_variance, int* __restrict out_u,
               int* __restrict out_v) {
  const Eigen::Matrix3f r = to.view_from_surfaces.rotation;
  const Eigen::Vector3f t = to.view_from_surfaces.translation;
  for (int i = 0; i < num; ++i) {
    const float px = r(0, 0) * x[i] + r(0, 1) * y[i] + r(0, 2) * z[i] + t[0];
    const float py = r(1, 0) * x[i] + r(1, 1) * y[i] + r(1, 2) * z[i] + t[1];
    const float pz = r(2, 0) * x[i] + r(2, 1) * y[i] + r(2, 2) * z[i] + t[2];
    const float along_x = (r(0, 0) * nx[i] + r(0, 1) * ny[i] + r(0, 2) * nz[i]) * px;
    const float along_y = (r(1, 0) * nx[i] + r(1, 1) * ny[i] + r(1, 2) * nz[i]) * py;
    const float along_z = (r(2, 0) * nx[i] + r(2, 1) * ny[i] + r(2, 2) * nz[i]) * pz;
    const float slope = std::abs(along_x + along_y + along_z) / pz;
    const float u = to.fx * px / pz + to.left_px;
    const float v = to.fy * py / pz + to.top_px;
    const bool has_normal = slope == slope;
    const bool is_visible = (pz > 0) & (!has_normal | (slope > kMinViewingCosine)) & (u >= 0) & (v >= 0) &
                            (u < to.width_px) & (v < to.height_px);  // false for NaN
    out_z_m[i] = pz;
    out_slope[i] = has_normal ? slope : 1.0F;
    out_variance[i] = sigma_m[i] * sigma_m[i];
    out_u[i] = static_cast<int>(is_visible ? u : -1.0F);
    out_v[i] = static_cast<int>(is_visible ? v : -1.0F);
  }
}

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

  /// Whether the measurement where the surface projects to lies behind it. The surface must be visible.
  [[nodiscard]] bool sees_through(const SurfaceInView& surface) const {
    return compare(surface, view_.frame.depth_m.index(surface.u, surface.v)) == Evidence::kSeenThrough;
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

/// Whether the surface of the pixel ends there, before one behind it. Contours are depth edges, with the
/// default of prepare.edges.max_depth_jump: looking only there saves most of the time.
bool is_contour(const PreparedView& view, int u, int v) {
  if (view.edge_distance_px(u, v) > 0 || std::isnan(view.cloud.z(u, v))) return false;
  return std::ranges::any_of(kPixelSteps,
                             [&](PixelStep step) { return is_occluding_contour(view.frame.depth_m, u, v, step); });
}

void check_view(const PreparedView& view) {
  const auto has_size = [&](const auto& image) {
    return image.width() == view.frame.camera.width && image.height() == view.frame.camera.height;
  };
  require(view.frame.camera.is_valid() && has_size(view.frame.depth_m) && has_size(view.cloud.z) &&
              has_size(view.cloud.nx) && has_size(view.edge_distance_px) && has_size(view.noise.normal_m),
          "compare_views: a view is not prepared (its images have not its camera's size)");
}

/// `recolored` receives what is seen through by a distance that counts where colours differ; null: nothing.
ViewComparison compare_depths(const SurfaceComparison& by_depth, const SurfaceComparison* with_color,
                              const OrganizedCloud& surfaces, const CompareViewsOptions& options) {
  ViewComparison result{Image<Evidence>(surfaces.width(), surfaces.height(), Evidence::kUnobserved),
                        Image<int>(surfaces.width(), surfaces.height()),
                        Image<std::uint8_t>(surfaces.width(), surfaces.height()),
                        Image<float>(surfaces.width(), surfaces.height(), 1)};
  parallel_for_blocks(static_cast<std::size_t>(surfaces.height()), kComparedRows, options.num_threads,
                      [&](std::size_t begin, std::size_t end) {
                        PosedRow posed(surfaces.width());
                        for (auto v = static_cast<int>(begin); v < static_cast<int>(end); ++v) {
                          by_depth.pose_row(v, posed);
                          for (int u = 0; u < surfaces.width(); ++u) {
                            const Evidence evidence = by_depth.classify(posed[u], options.window_radius_px);
                            result.evidence(u, v) = evidence;
                            result.pixels(u, v) = by_depth.index(posed[u]);
                            if (with_color != nullptr && is_observed(evidence) && with_color->sees_through(posed[u]))
                              result.recolored(u, v) = 1;
                          }
                        }
                      });
  return result;
}

/// Keeps `recolored` where colours differ, and lets it decide there.
void compare_colors(const PreparedView& surfaces, const PreparedView& view, const SurfaceComparison& with_color,
                    const CompareViewsOptions& options, ViewComparison& result) {
  std::vector<int> candidates;
  for (std::size_t i = 0; i < result.recolored.size(); ++i)
    if (std::exchange(result.recolored[i], 0) != 0) candidates.push_back(static_cast<int>(i));
  // A still camera's colours may lie a pixel beside each other: it interpolates them.
  const int radius_px = std::max(options.window_radius_px, 1);
  const ColorChanges colors = find_color_changes(surfaces, view, result.pixels, candidates, radius_px);
  for (const int i : colors.same) result.weight[static_cast<std::size_t>(i)] = static_cast<float>(colors.similar_share);
  for (const int i : colors.changed) {
    const auto at = static_cast<std::size_t>(i);
    const Evidence evidence = with_color.classify(with_color.pose(at), options.window_radius_px);
    if (evidence != Evidence::kSeenThrough) continue;
    result.evidence[at] = evidence;
    result.recolored[at] = 1;
  }
}

}  // namespace

ViewComparison compare_views(const PreparedView& surfaces, const PreparedView& view, double noise_scale,
                             const CompareViewsOptions& options) {
  options.check();
  check_positive("noise_scale", noise_scale);
  check_view(surfaces);
  check_view(view);
  const SurfaceComparison by_depth(surfaces, view, static_cast<float>(options.sigmas * noise_scale));
  if (!options.recolored_sigmas) return compare_depths(by_depth, nullptr, surfaces.cloud, options);
  const double recolored_sigmas = std::min(*options.recolored_sigmas, options.sigmas);
  const SurfaceComparison with_color(surfaces, view, static_cast<float>(recolored_sigmas * noise_scale));
  ViewComparison result = compare_depths(by_depth, &with_color, surfaces.cloud, options);
  compare_colors(surfaces, view, with_color, options, result);
  return result;
}

std::vector<float> measure_contradiction(const PreparedView& surfaces, const PreparedView& view,
                                         std::span<const int> pixels, double noise_scale) {
  check_positive("noise_scale", noise_scale);
  check_view(surfaces);
  check_view(view);
  const SurfaceComparison comparison(surfaces, view, 1);
  std::vector<float> sigmas;
  for (const int i : pixels)
    sigmas.push_back(comparison.normalized_distance(comparison.pose(static_cast<std::size_t>(i)),
                                                    std::numeric_limits<float>::max()) /
                     static_cast<float>(noise_scale));
  return sigmas;
}

double estimate_noise_scale(const PreparedView& surfaces, const PreparedView& view) {
  check_view(surfaces);
  check_view(view);
  const SurfaceComparison comparison(surfaces, view, 1);
  std::vector<float> distances;
  PosedRow posed(surfaces.cloud.width());
  for (int v = 0; v < surfaces.cloud.height(); v += kScaleStep_px) {
    comparison.pose_row(v, posed);
    for (int u = 0; u < surfaces.cloud.width(); u += kScaleStep_px) {
      const float distance = comparison.normalized_distance(posed[u], kMaxScaleDistance_m);
      if (!std::isnan(distance)) distances.push_back(std::abs(distance));
    }
  }
  if (distances.size() < kMinScaleSamples) return 1;
  return std::max(kMinNoiseScale, kNormalizedMad * static_cast<double>(upper_median(std::move(distances))));
}

int estimate_misregistration_px(const PreparedView& surfaces, const PreparedView& view, double noise_scale,
                                double sigmas) {
  check_positive("noise_scale", noise_scale);
  check_view(surfaces);
  check_view(view);
  const SurfaceComparison comparison(surfaces, view, static_cast<float>(sigmas * noise_scale));
  std::array<int, kMaxMisregistration_px + 1> num_at_radius{};
  int num_explained = 0;
  for (int v = 0; v < surfaces.cloud.height(); ++v)
    for (int u = v % 2; u < surfaces.cloud.width(); u += 2) {  // Half of the pixels is enough for a share.
      if (!is_contour(surfaces, u, v)) continue;
      const std::optional<int> radius_px =
          comparison.find_agreeing_radius(surfaces.cloud.z.index(u, v), kMaxMisregistration_px);
      if (!radius_px) continue;
      ++num_at_radius[static_cast<std::size_t>(*radius_px)];
      ++num_explained;
    }
  if (num_explained < kMinContourPixels) return 0;
  int radius_px = 0;
  for (int num_within = num_at_radius[0]; num_within < kExplainedShare * num_explained;)
    num_within += num_at_radius[static_cast<std::size_t>(++radius_px)];
  return radius_px;
}

}  // namespace resight
