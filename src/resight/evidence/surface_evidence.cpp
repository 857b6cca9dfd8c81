// SPDX-License-Identifier: Apache-2.0
#include "resight/evidence/surface_evidence.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "resight/core/check.hpp"
#include "resight/core/parallel.hpp"
#include "resight/sensor/noise_model.hpp"

namespace resight {
namespace {

constexpr std::size_t kPointsPerTask = 4096;

// A surface at its pose before the camera.
class PosedSurface {
 public:
  PosedSurface(const OrientedPoints& surface, const Rigid3& camera_from_surface, double min_viewing_cosine)
      : surface_(surface),
        camera_from_surface_(camera_from_surface),
        min_cosine_(static_cast<float>(min_viewing_cosine)) {}

  [[nodiscard]] Eigen::Vector3f point(std::size_t i) const { return camera_from_surface_ * surface_.points[i]; }
  [[nodiscard]] bool faces_camera(std::size_t i, const Eigen::Vector3f& p_in_camera) const {
    if (surface_.normals.empty()) return true;
    const float cosine = -(camera_from_surface_.rotation * surface_.normals[i]).dot(p_in_camera) / p_in_camera.norm();
    return !(cosine < min_cosine_);
  }

 private:
  const OrientedPoints& surface_;
  Rigid3f camera_from_surface_;
  float min_cosine_;
};

}  // namespace

float DepthMargin::at(float z_m, double focal_px) const {
  if (noise_sigmas <= 0) return static_cast<float>(base_m);
  return static_cast<float>(base_m + noise_sigmas * nguyen_noise(z_m, 0, focal_px).axial_m);
}

float nearest_depth(const Eigen::Vector3f& p_in_camera, const DepthImage& view, int radius_px) {
  const Image<float>& depth_m = view.depth_m;
  float nearest = std::numeric_limits<float>::quiet_NaN();
  const std::optional<Pixel> pixel = view.camera.pixel_of(p_in_camera.cast<double>());
  if (!pixel) return nearest;
  if (radius_px == 0) return depth_m(pixel->u, pixel->v);
  for (int v = std::max(pixel->v - radius_px, 0); v <= std::min(pixel->v + radius_px, depth_m.height() - 1); ++v)
    for (int u = std::max(pixel->u - radius_px, 0); u <= std::min(pixel->u + radius_px, depth_m.width() - 1); ++u)
      nearest = std::fmin(nearest, depth_m(u, v));  // fmin() prefers a number to NaN.
  return nearest;
}

Evidence classify_point(const Eigen::Vector3f& p_in_camera, const DepthImage& view, const DepthMargin& margin,
                        int window_radius_px) {
  const float measured_m = nearest_depth(p_in_camera, view, window_radius_px);
  if (std::isnan(measured_m)) return Evidence::kUnobserved;
  return compare_depth(p_in_camera.z(), measured_m, margin.at(p_in_camera.z(), view.camera.fx));
}

SurfaceEvidence classify_surface(const OrientedPoints& surface, const Rigid3& camera_from_surface,
                                 const DepthImage& view, const SurfaceEvidenceOptions& options) {
  options.check();
  require(view.camera.is_valid() && view.camera.width == view.depth_m.width() &&
              view.camera.height == view.depth_m.height(),
          "classify_surface: the camera is not that of the depth image");
  require(surface.normals.empty() || surface.normals.size() == surface.points.size(),
          "classify_surface: there must be one normal per point, or none");
  const PosedSurface posed(surface, camera_from_surface, options.min_viewing_cosine);
  SurfaceEvidence result;
  result.points.assign(surface.points.size(), Evidence::kUnobserved);
  std::vector<std::uint8_t> faces_camera(surface.points.size());
  parallel_for_blocks(surface.points.size(), kPointsPerTask, options.num_threads,
                      [&](std::size_t begin, std::size_t end) {
                        for (std::size_t i = begin; i < end; ++i) {
                          const Eigen::Vector3f p = posed.point(i);
                          if (!posed.faces_camera(i, p)) continue;
                          faces_camera[i] = 1;
                          result.points[i] = classify_point(p, view, options.margin, options.window_radius_px);
                        }
                      });
  for (std::size_t i = 0; i < result.points.size(); ++i)
    result.count[static_cast<std::size_t>(result.points[i])] += faces_camera[i];
  return result;
}

}  // namespace resight
