// SPDX-License-Identifier: Apache-2.0
#include "resight/evidence/surface_evidence.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "resight/core/check.hpp"
#include "resight/core/parallel.hpp"
#include "resight/sensor/noise_model.hpp"

namespace resight {
namespace {

constexpr std::size_t kGrain = 4096;
constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();

Evidence judge_depth(float z, float surface_m, float margin_m) {
  if (std::isnan(surface_m)) return Evidence::kUnobserved;
  if (surface_m < z - margin_m) return Evidence::kOccluded;
  return surface_m > z + margin_m ? Evidence::kSeenThrough : Evidence::kPresent;
}

}  // namespace

void DepthEvidenceOptions::check() const {
  check_in_range("DepthEvidenceOptions.window_radius_px", window_radius_px, 0, 100);
  check_not_negative("DepthEvidenceOptions.margin_m", margin_m);
  check_not_negative("DepthEvidenceOptions.noise_sigmas", noise_sigmas);
  check_positive("DepthEvidenceOptions.num_threads", num_threads);
}

float nearest_depth(const Eigen::Vector3f& p_in_camera, const Camera& camera, const Image<float>& depth_m,
                    int radius_px) {
  if (!(p_in_camera.z() > 0)) return kNaN;
  const Eigen::Vector2d pixel = camera.project(p_in_camera.cast<double>());
  if (!camera.contains(pixel)) return kNaN;  // also for NaN
  const int u = static_cast<int>(std::floor(pixel.x() + 0.5));
  const int v = static_cast<int>(std::floor(pixel.y() + 0.5));
  float nearest = kNaN;
  for (int y = std::max(v - radius_px, 0); y <= std::min(v + radius_px, depth_m.height() - 1); ++y)
    for (int x = std::max(u - radius_px, 0); x <= std::min(u + radius_px, depth_m.width() - 1); ++x)
      nearest = std::fmin(nearest, depth_m(x, y));  // fmin prefers a number to NaN
  return nearest;
}

std::vector<Evidence> classify_against_depth(std::span<const Eigen::Vector3f> queries_in_camera, const Camera& camera,
                                             const Image<float>& depth_m, const DepthEvidenceOptions& options) {
  options.check();
  require(camera.is_valid() && camera.width == depth_m.width() && camera.height == depth_m.height(),
          "classify_against_depth: the camera is not that of the depth image");
  std::vector<Evidence> evidence(queries_in_camera.size(), Evidence::kUnobserved);
  parallel_for_blocks(queries_in_camera.size(), kGrain, options.num_threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const Eigen::Vector3f& p = queries_in_camera[i];
      const float surface_m = nearest_depth(p, camera, depth_m, options.window_radius_px);
      if (std::isnan(surface_m)) continue;
      const double sigma_m = nguyen_noise(p.z(), 0, camera.fx).axial_m;
      evidence[i] =
          judge_depth(p.z(), surface_m, static_cast<float>(options.margin_m + options.noise_sigmas * sigma_m));
    }
  });
  return evidence;
}

}  // namespace resight
