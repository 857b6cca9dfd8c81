// SPDX-License-Identifier: Apache-2.0
#include "resight/evidence/view_comparison.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

#include "resight/core/check.hpp"
#include "resight/core/parallel.hpp"
#include "resight/sensor/occluding_contour.hpp"

namespace resight {
namespace {

constexpr std::size_t kComparedRows = 8;
constexpr int kScaleStep_px = 4;               // One pixel in 16 is enough for a median.
constexpr std::size_t kMinScaleSamples = 500;  // With fewer, the median says little.
constexpr float kMaxScaleDistance_m = 0.1F;    // Larger differences are other surfaces.
constexpr float kMinViewingCosine = 0.05F;     // 87 deg: at more grazing angles depth says nothing about a surface.
constexpr double kNormalizedMad = 1.4826;      // Standard deviation of a normal distribution / median |x|.
// Depth is quantised: the median of small differences may be 0, though the noise is not.
constexpr double kMinNoiseScale = 0.7;
constexpr int kMaxMisregistration_px = 8;  // Beyond, other surfaces agree by chance.
constexpr double kExplainedShare = 0.9;    // The rest agree by chance.
constexpr int kMinContourPixels = 25;      // With fewer, the share says little.

/// A measured surface in front of the other camera.
struct SurfaceInView {
  Eigen::Vector3f position;  ///< In that camera.
  float slope;               ///< Distance along the normal per metre along z.
  float variance;            ///< Of the distance along the normal; m^2.
};

class ViewComparison {
 public:
  ViewComparison(const PreparedView& surfaces, const PreparedView& view, float sigmas)
      : surfaces_(surfaces),
        view_(view),
        view_from_surfaces_(view.frame.world_from_camera.inverse() * surfaces.frame.world_from_camera),
        sigmas_(sigmas) {}

  /// False if the pixel has no surface, or one behind the other camera or seen at too grazing an angle.
  bool pose(std::size_t i, SurfaceInView& surface) const {
    const OrganizedCloud& cloud = surfaces_.cloud;
    if (!cloud.has_point(i)) return false;
    const Eigen::Vector3f p = view_from_surfaces_ * cloud.point(i);
    if (!(p.z() > 0)) return false;
    surface.position = p;
    surface.slope = 1;
    const float sigma_m = surfaces_.noise.normal_m[i];
    surface.variance = sigma_m * sigma_m;
    if (!cloud.has_normal(i)) return true;
    surface.slope = std::abs((view_from_surfaces_.rotation * cloud.normal(i)).dot(p)) / p.z();
    return surface.slope > kMinViewingCosine;
  }

  [[nodiscard]] std::optional<Pixel> pixel_of(const SurfaceInView& surface) const {
    return view_.frame.camera.pixel_of(surface.position.cast<double>());
  }

  [[nodiscard]] Evidence classify(std::size_t i, int radius_px) const {
    SurfaceInView surface;
    if (!pose(i, surface)) return Evidence::kUnobserved;
    const std::optional<Pixel> pixel = pixel_of(surface);
    if (!pixel) return Evidence::kUnobserved;
    const Evidence center = compare(surface, view_.frame.depth_m.index(pixel->u, pixel->v));
    if (center == Evidence::kPresent) return center;
    return agree_in_window(surface, *pixel, radius_px, center);
  }

  /// The smallest window around the pixel that the surface projects to with a measurement that agrees with it, in rows
  /// and columns on each side. 0: the measurement of the pixel itself agrees. Nothing if none within the largest does,
  /// or if the pixel has no measurement.
  [[nodiscard]] std::optional<int> find_agreeing_radius(std::size_t i, int max_radius_px) const {
    SurfaceInView surface;
    if (!pose(i, surface)) return std::nullopt;
    const std::optional<Pixel> pixel = pixel_of(surface);
    if (!pixel || std::isnan(view_.frame.depth_m(pixel->u, pixel->v))) return std::nullopt;
    for (int radius_px = 0; radius_px <= max_radius_px; ++radius_px)
      if (agrees_on_ring(surface, *pixel, radius_px)) return radius_px;
    return std::nullopt;
  }

  /// Distance of the surface to the measurement where it projects to, in standard deviations; NaN if there is none.
  [[nodiscard]] float normalized_distance(std::size_t i, float max_distance_m) const {
    SurfaceInView surface;
    if (!pose(i, surface)) return kNaN;
    const std::optional<Pixel> pixel = pixel_of(surface);
    if (!pixel) return kNaN;
    const std::size_t j = view_.frame.depth_m.index(pixel->u, pixel->v);
    const float distance_m = (view_.frame.depth_m[j] - surface.position.z()) * surface.slope;
    return std::abs(distance_m) < max_distance_m ? distance_m / sigma(surface, j) : kNaN;
  }

 private:
  static constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();

  [[nodiscard]] float sigma(const SurfaceInView& surface, std::size_t j) const {
    const float sigma_m = view_.noise.normal_m[j];
    // Beyond prepare.max_depth_m there is depth, but no noise. Such a measurement is far behind.
    return std::sqrt(surface.variance + (std::isnan(sigma_m) ? 0.0F : sigma_m * sigma_m));
  }
  [[nodiscard]] Evidence compare(const SurfaceInView& surface, std::size_t j) const {
    return compare_depth(surface.position.z(), view_.frame.depth_m[j], sigmas_ * sigma(surface, j) / surface.slope);
  }

  /// Whether a measurement at this Chebyshev distance from the pixel agrees with the surface.
  [[nodiscard]] bool agrees_on_ring(const SurfaceInView& surface, Pixel center, int radius_px) const {
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
  [[nodiscard]] Evidence agree_in_window(const SurfaceInView& surface, Pixel center, int radius_px,
                                         Evidence evidence) const {
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
  Rigid3f view_from_surfaces_;
  float sigmas_;
};

/// Whether the surface of the pixel ends there, before one behind it.
bool is_contour(const Image<float>& depth_m, int u, int v) {
  return std::ranges::any_of(kPixelSteps, [&](PixelStep step) { return is_occluding_contour(depth_m, u, v, step); });
}

void check_view(const PreparedView& view) {
  const auto has_size = [&](const auto& image) {
    return image.width() == view.frame.camera.width && image.height() == view.frame.camera.height;
  };
  require(view.frame.camera.is_valid() && has_size(view.frame.depth_m) && has_size(view.cloud.z) &&
              has_size(view.noise.normal_m),
          "compare_views: a view is not prepared (its images have not its camera's size)");
}

}  // namespace

Image<Evidence> compare_views(const PreparedView& surfaces, const PreparedView& view, double noise_scale,
                              const CompareViewsOptions& options) {
  options.check();
  check_positive("noise_scale", noise_scale);
  check_view(surfaces);
  check_view(view);
  const ViewComparison comparison(surfaces, view, static_cast<float>(options.sigmas * noise_scale));
  Image<Evidence> evidence(surfaces.cloud.width(), surfaces.cloud.height(), Evidence::kUnobserved);
  parallel_for_blocks(static_cast<std::size_t>(evidence.height()), kComparedRows, options.num_threads,
                      [&](std::size_t begin, std::size_t end) {
                        const auto width = static_cast<std::size_t>(evidence.width());
                        for (std::size_t i = begin * width; i < end * width; ++i)
                          evidence[i] = comparison.classify(i, options.window_radius_px);
                      });
  return evidence;
}

std::vector<float> measure_contradiction(const PreparedView& surfaces, const PreparedView& view,
                                         std::span<const int> pixels, double noise_scale) {
  check_positive("noise_scale", noise_scale);
  check_view(surfaces);
  check_view(view);
  const ViewComparison comparison(surfaces, view, 1);
  std::vector<float> sigmas;
  for (const int i : pixels)
    sigmas.push_back(comparison.normalized_distance(static_cast<std::size_t>(i), std::numeric_limits<float>::max()) /
                     static_cast<float>(noise_scale));
  return sigmas;
}

double estimate_noise_scale(const PreparedView& surfaces, const PreparedView& view) {
  check_view(surfaces);
  check_view(view);
  const ViewComparison comparison(surfaces, view, 1);
  std::vector<float> distances;
  for (int v = 0; v < surfaces.cloud.height(); v += kScaleStep_px)
    for (int u = 0; u < surfaces.cloud.width(); u += kScaleStep_px) {
      const float distance = comparison.normalized_distance(surfaces.cloud.z.index(u, v), kMaxScaleDistance_m);
      if (!std::isnan(distance)) distances.push_back(std::abs(distance));
    }
  if (distances.size() < kMinScaleSamples) return 1;
  const auto middle = distances.begin() + static_cast<std::ptrdiff_t>(distances.size() / 2);
  std::nth_element(distances.begin(), middle, distances.end());
  return std::max(kMinNoiseScale, kNormalizedMad * static_cast<double>(*middle));
}

int estimate_misregistration_px(const PreparedView& surfaces, const PreparedView& view, double noise_scale,
                                double sigmas) {
  check_positive("noise_scale", noise_scale);
  check_view(surfaces);
  check_view(view);
  const ViewComparison comparison(surfaces, view, static_cast<float>(sigmas * noise_scale));
  std::array<int, kMaxMisregistration_px + 1> num_at_radius{};
  int num_explained = 0;
  for (int v = 0; v < surfaces.cloud.height(); ++v)
    for (int u = v % 2; u < surfaces.cloud.width(); u += 2) {  // Half of the pixels is enough for a share.
      if (!surfaces.cloud.has_point(surfaces.cloud.z.index(u, v)) || !is_contour(surfaces.frame.depth_m, u, v))
        continue;
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
