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
#include "resight/evidence/internal/surface_comparison.hpp"
#include "resight/evidence/mean_distances.hpp"
#include "resight/sensor/occluding_contour.hpp"

namespace resight {
namespace {

constexpr std::size_t kComparedRows = 8;
constexpr int kScaleStep_px = 4;               // One pixel in 16 is enough for a median.
constexpr std::size_t kMinScaleSamples = 500;  // With fewer, the median says little.
constexpr float kMaxScaleDistance_m = 0.1F;    // Larger differences are other surfaces.
// Depth is quantised: the median of small differences may be 0, though the noise is not.
constexpr double kMinNoiseScale = 0.7;
constexpr int kMaxMisregistration_px = 8;  // Beyond, other surfaces agree by chance.
constexpr double kExplainedShare = 0.9;    // The rest agree by chance.
constexpr int kMinContourPixels = 25;      // With fewer, the share says little.

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
          "compare_views: a view is not prepared (its images do not have the size of its camera)");
}

/// What follows from depth alone, and the distances between surfaces and measurements.
struct DepthComparison {
  ViewComparison result;
  Image<float> sigmas;  ///< In standard deviations; positive if the measurement lies behind; NaN: none.
};

/// 0 at the least difference that counts, 1 from twice that on.
float contradiction_of(float difference, double limit) {
  return std::clamp(difference / static_cast<float>(limit) - 1, 0.0F, 1.0F);
}

DepthComparison compare_depths(const SurfaceComparison& comparison, const OrganizedCloud& surfaces, double noise_scale,
                               const CompareViewsOptions& options) {
  const Image<float> zeros(surfaces.width(), surfaces.height());
  DepthComparison by_depth{{Image<Evidence>(zeros.width(), zeros.height(), Evidence::kUnobserved),
                            Image<int>(zeros.width(), zeros.height()), zeros},
                           zeros};
  ViewComparison& result = by_depth.result;
  parallel_for_blocks(static_cast<std::size_t>(zeros.height()), kComparedRows, options.num_threads,
                      [&](std::size_t begin, std::size_t end) {
                        PosedRow posed(zeros.width());
                        for (auto v = static_cast<int>(begin); v < static_cast<int>(end); ++v) {
                          comparison.pose_row(v, posed);
                          for (int u = 0; u < zeros.width(); ++u) {
                            const Evidence evidence = comparison.classify(posed[u], options.window_radius_px);
                            const float sigmas =
                                comparison.normalized_distance(posed[u], std::numeric_limits<float>::max()) /
                                static_cast<float>(noise_scale);
                            result.evidence(u, v) = evidence;
                            result.pixels(u, v) = comparison.index(posed[u]);
                            by_depth.sigmas(u, v) = sigmas;
                            if (evidence == Evidence::kSeenThrough &&
                                (options.contour_radius_px <= options.window_radius_px ||
                                 comparison.classify(posed[u], options.contour_radius_px) == evidence))
                              result.contradiction(u, v) = contradiction_of(sigmas, options.sigmas);
                          }
                        }
                      });
  return by_depth;
}

/// Lets colours decide what depth leaves open.
class ColorDecision {
 public:
  ColorDecision(const PreparedView& surfaces, const PreparedView& view, double noise_scale,
                const CompareViewsOptions& options, DepthComparison by_depth)
      : surfaces_(surfaces),
        view_(view),
        options_(options),
        recolored_sigmas_(std::min(*options.recolored_sigmas, options.sigmas)),
        by_depth_(std::move(by_depth)),
        means_(by_depth_.sigmas, static_cast<float>(options.sigmas)),
        with_color_(surfaces, view, static_cast<float>(recolored_sigmas_ * noise_scale)) {}

  [[nodiscard]] ViewComparison decide() && {
    ViewComparison& result = by_depth_.result;
    // A still camera's colours may lie a pixel beside each other: it interpolates them.
    const int radius_px = std::max(options_.window_radius_px, 1);
    const ColorChanges colors = find_color_changes(surfaces_, view_, result.pixels, find_candidates(), radius_px);
    for (const int i : colors.same)
      result.contradiction[static_cast<std::size_t>(i)] *= static_cast<float>(colors.similar_share);
    for (const int i : colors.standing_out)
      if (!sees_through_pixel(static_cast<std::size_t>(i))) see_through_mean(static_cast<std::size_t>(i));
    for (const int i : colors.different) see_through_mean(static_cast<std::size_t>(i));
    return std::move(result);
  }

 private:
  [[nodiscard]] std::vector<int> find_candidates() const {
    std::vector<int> candidates;
    for (std::size_t i = 0; i < by_depth_.sigmas.size(); ++i)
      if (is_observed(by_depth_.result.evidence[i]) && (by_depth_.sigmas[i] > static_cast<float>(recolored_sigmas_) ||
                                                        mean_at(i) > static_cast<float>(options_.sigmas)))
        candidates.push_back(static_cast<int>(i));
    return candidates;
  }
  [[nodiscard]] float mean_at(std::size_t i) const {
    const auto width = static_cast<std::size_t>(by_depth_.sigmas.width());
    return means_.at(static_cast<int>(i % width), static_cast<int>(i / width));
  }

  /// By the distance of the pixel itself.
  bool sees_through_pixel(std::size_t i) {
    if (!(by_depth_.sigmas[i] > static_cast<float>(recolored_sigmas_))) return false;
    if (with_color_.classify(with_color_.pose(i), options_.window_radius_px) != Evidence::kSeenThrough) return false;
    see_through(i, contradiction_of(by_depth_.sigmas[i], recolored_sigmas_));
    return true;
  }
  void see_through_mean(std::size_t i) {
    const float mean = mean_at(i);
    if (by_depth_.result.evidence[i] == Evidence::kPresent && mean > static_cast<float>(options_.sigmas))
      see_through(i, contradiction_of(mean, options_.sigmas));
  }
  void see_through(std::size_t i, float contradiction) {
    by_depth_.result.evidence[i] = Evidence::kSeenThrough;
    by_depth_.result.contradiction[i] = contradiction;
  }

  const PreparedView& surfaces_;
  const PreparedView& view_;
  const CompareViewsOptions& options_;
  double recolored_sigmas_;
  DepthComparison by_depth_;
  MeanDistances means_;
  SurfaceComparison with_color_;
};

}  // namespace

ViewComparison compare_views(const PreparedView& surfaces, const PreparedView& view, double noise_scale,
                             const CompareViewsOptions& options) {
  options.check();
  check_positive("noise_scale", noise_scale);
  check_view(surfaces);
  check_view(view);
  const SurfaceComparison comparison(surfaces, view, static_cast<float>(options.sigmas * noise_scale));
  DepthComparison by_depth = compare_depths(comparison, surfaces.cloud, noise_scale, options);
  const bool have_colors =
      surfaces.surface_color().size() == surfaces.cloud.z.size() && view.surface_color().size() == view.cloud.z.size();
  if (!options.recolored_sigmas || !have_colors) return std::move(by_depth.result);
  return ColorDecision(surfaces, view, noise_scale, options, std::move(by_depth)).decide();
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
