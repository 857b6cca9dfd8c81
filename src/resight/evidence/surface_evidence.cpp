// SPDX-License-Identifier: Apache-2.0
#include "resight/evidence/surface_evidence.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "resight/core/check.hpp"
#include "resight/core/parallel.hpp"
#include "resight/evidence/self_occlusion.hpp"
#include "resight/sensor/noise_model.hpp"

namespace resight {
namespace {

constexpr std::size_t kPointsPerTask = 4096;

// A surface at its pose before the camera. Its points are projected only to find what the surface itself hides; then
// the positions also serve to look up the depth.
class PosedSurface {
 public:
  PosedSurface(const OrientedPoints& surface, const Rigid3& camera_from_surface, const Camera& camera,
               std::optional<double> spacing_m)
      : surface_(surface), camera_from_surface_(camera_from_surface), camera_(camera) {
    if (!spacing_m) return;
    projected_.reserve(surface.points.size());
    for (std::size_t i = 0; i < surface.points.size(); ++i) projected_.push_back(project(i));
    self_.emplace(projected_, static_cast<float>(camera.fx), static_cast<float>(*spacing_m));
  }

  [[nodiscard]] Eigen::Vector3f point(std::size_t i) const { return camera_from_surface_ * surface_.points[i]; }
  [[nodiscard]] float viewing_cosine(std::size_t i, const Eigen::Vector3f& p_in_camera) const {
    if (surface_.normals.empty()) return 1;
    if (i < projected_.size() && projected_[i].z > 0) return projected_[i].viewing_cosine;
    return -(camera_from_surface_.rotation * surface_.normals[i]).dot(p_in_camera) / p_in_camera.norm();
  }
  [[nodiscard]] std::optional<Pixel> pixel(std::size_t i, const Eigen::Vector3f& p_in_camera) const {
    if (!self_) return camera_.pixel_of(p_in_camera.cast<double>());
    const ProjectedPoint& p = projected_[i];
    return p.z > 0 ? camera_.pixel_at({p.u, p.v}) : std::nullopt;
  }
  [[nodiscard]] bool hides_itself(std::size_t i) const { return self_ && self_->hides(projected_[i]); }

 private:
  [[nodiscard]] ProjectedPoint project(std::size_t i) const {
    const Eigen::Vector3f p = point(i);
    if (!(p.z() > SelfOcclusion::kMinDepth_m)) return {};
    return {static_cast<float>(camera_.fx) * p.x() / p.z() + static_cast<float>(camera_.cx),
            static_cast<float>(camera_.fy) * p.y() / p.z() + static_cast<float>(camera_.cy), p.z(),
            viewing_cosine(i, p)};
  }

  const OrientedPoints& surface_;
  Rigid3f camera_from_surface_;
  const Camera& camera_;
  std::vector<ProjectedPoint> projected_;
  std::optional<SelfOcclusion> self_;
};

float nearest_in_window(const Image<float>& depth_m, Pixel center, int radius_px) {
  if (radius_px == 0) return depth_m(center.u, center.v);
  float nearest = std::numeric_limits<float>::quiet_NaN();
  for (int v = std::max(center.v - radius_px, 0); v <= std::min(center.v + radius_px, depth_m.height() - 1); ++v)
    for (int u = std::max(center.u - radius_px, 0); u <= std::min(center.u + radius_px, depth_m.width() - 1); ++u)
      nearest = std::fmin(nearest, depth_m(u, v));  // fmin() prefers a number to NaN.
  return nearest;
}

Evidence classify_at(std::optional<Pixel> pixel, float z_m, const DepthImage& view, const DepthMargin& margin,
                     int window_radius_px) {
  if (!pixel) return Evidence::kUnobserved;
  const float measured_m = nearest_in_window(view.depth_m, *pixel, window_radius_px);
  if (std::isnan(measured_m)) return Evidence::kUnobserved;
  return compare_depth(z_m, measured_m, margin.at(z_m, view.camera.fx));
}

}  // namespace

float DepthMargin::at(float z_m, double focal_px) const {
  if (noise_sigmas <= 0) return static_cast<float>(base_m);
  return static_cast<float>(base_m + noise_sigmas * nguyen_noise(z_m, 0, focal_px).axial_m);
}

float nearest_depth(const Eigen::Vector3f& p_in_camera, const DepthImage& view, int radius_px) {
  const std::optional<Pixel> pixel = view.camera.pixel_of(p_in_camera.cast<double>());
  return pixel ? nearest_in_window(view.depth_m, *pixel, radius_px) : std::numeric_limits<float>::quiet_NaN();
}

Evidence classify_point(const Eigen::Vector3f& p_in_camera, const DepthImage& view, const DepthMargin& margin,
                        int window_radius_px) {
  return classify_at(view.camera.pixel_of(p_in_camera.cast<double>()), p_in_camera.z(), view, margin, window_radius_px);
}

SurfaceEvidence classify_surface(const OrientedPoints& surface, const Rigid3& camera_from_surface,
                                 const DepthImage& view, const SurfaceEvidenceOptions& options) {
  options.check();
  require(view.camera.is_valid() && view.camera.width == view.depth_m.width() &&
              view.camera.height == view.depth_m.height(),
          "classify_surface: the camera is not that of the depth image");
  require(surface.normals.empty() || surface.normals.size() == surface.points.size(),
          "classify_surface: there must be one normal per point, or none");
  const PosedSurface posed(surface, camera_from_surface, view.camera, options.self_occlusion_spacing_m);
  const auto min_cosine = static_cast<float>(options.min_viewing_cosine);
  SurfaceEvidence result;
  result.points.assign(surface.points.size(), Evidence::kUnobserved);
  result.viewing_cosine.resize(surface.points.size());
  const auto classify = [&](std::size_t i) {
    const Eigen::Vector3f p = posed.point(i);
    result.viewing_cosine[i] = posed.viewing_cosine(i, p);
    if (result.viewing_cosine[i] < min_cosine) return;
    const Evidence evidence = classify_at(posed.pixel(i, p), p.z(), view, options.margin, options.window_radius_px);
    result.points[i] = is_observed(evidence) && posed.hides_itself(i) ? Evidence::kOccluded : evidence;
  };
  parallel_for_blocks(surface.points.size(), kPointsPerTask, options.num_threads,
                      [&](std::size_t begin, std::size_t end) {
                        for (std::size_t i = begin; i < end; ++i) classify(i);
                      });
  for (std::size_t i = 0; i < result.points.size(); ++i)
    if (!(result.viewing_cosine[i] < min_cosine)) ++result.count[static_cast<std::size_t>(result.points[i])];
  return result;
}

}  // namespace resight
