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

// Passes pointers as parameters, because compilers honour __restrict only there; otherwise the loop is not vectorised.
template <bool kHasNormals>
void project_points(const Rigid3f& camera_from_surface, const Camera& camera, std::size_t num,
                    const float* __restrict points, const float* __restrict normals,
                    ProjectedPoint* __restrict projected) {
  const Eigen::Matrix3f r = camera_from_surface.rotation;
  const Eigen::Vector3f t = camera_from_surface.translation;
  const auto fx = static_cast<float>(camera.fx), cx = static_cast<float>(camera.cx);
  const auto fy = static_cast<float>(camera.fy), cy = static_cast<float>(camera.cy);
  for (std::size_t i = 0; i < num; ++i) {
    const float px = points[3 * i], py = points[3 * i + 1], pz = points[3 * i + 2];
    const float x = r(0, 0) * px + r(0, 1) * py + r(0, 2) * pz + t[0];
    const float y = r(1, 0) * px + r(1, 1) * py + r(1, 2) * pz + t[1];
    const float z = r(2, 0) * px + r(2, 1) * py + r(2, 2) * pz + t[2];
    float cosine = 1;
    if constexpr (kHasNormals) {
      const float nx = normals[3 * i], ny = normals[3 * i + 1], nz = normals[3 * i + 2];
      const float along_x = (r(0, 0) * nx + r(0, 1) * ny + r(0, 2) * nz) * x;
      const float along_y = (r(1, 0) * nx + r(1, 1) * ny + r(1, 2) * nz) * y;
      const float along_z = (r(2, 0) * nx + r(2, 1) * ny + r(2, 2) * nz) * z;
      cosine = -(along_x + along_y + along_z) / std::sqrt(x * x + y * y + z * z);
    }
    projected[i].u = fx * x / z + cx;
    projected[i].v = fy * y / z + cy;
    projected[i].z = z;
    projected[i].viewing_cosine = cosine;
  }
}

float nearest_in_window(const Image<float>& depth_m, Pixel center, int radius_px) {
  float nearest = std::numeric_limits<float>::infinity();
  for (int v = std::max(center.v - radius_px, 0); v <= std::min(center.v + radius_px, depth_m.height() - 1); ++v)
    for (int u = std::max(center.u - radius_px, 0); u <= std::min(center.u + radius_px, depth_m.width() - 1); ++u)
      nearest = depth_m(u, v) < nearest ? depth_m(u, v) : nearest;  // false for NaN
  return std::isinf(nearest) ? std::numeric_limits<float>::quiet_NaN() : nearest;
}

float measured_depth(const Image<float>& depth_m, Pixel pixel, int window_radius_px) {
  if (window_radius_px == 0) return depth_m(pixel.u, pixel.v);
  return nearest_in_window(depth_m, pixel, window_radius_px);
}

Evidence classify_at(std::optional<Pixel> pixel, float z_m, const DepthImage& view, const DepthMargin& margin,
                     int window_radius_px) {
  if (!pixel) return Evidence::kUnobserved;
  const float measured_m = measured_depth(view.depth_m, *pixel, window_radius_px);
  return compare_depth(z_m, measured_m, margin.at(z_m, view.camera.noise));
}

}  // namespace

float DepthMargin::with_noise(float z_m, const DepthNoise& noise) const {
  return static_cast<float>(base_m + noise_sigmas * axial_noise_m(noise, z_m));
}

float nearest_depth(const Eigen::Vector3f& p_in_camera, const DepthImage& view, int radius_px) {
  const std::optional<Pixel> pixel = view.camera.pixel_of(p_in_camera.cast<double>());
  return pixel ? measured_depth(view.depth_m, *pixel, radius_px) : std::numeric_limits<float>::quiet_NaN();
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
  const std::size_t num = surface.points.size();
  const Rigid3f to_camera(camera_from_surface);
  std::vector<ProjectedPoint> projected(num);
  parallel_for_blocks(num, kPointsPerTask, options.num_threads, [&](std::size_t begin, std::size_t end) {
    const float* points = surface.points[begin].data();
    if (surface.normals.empty())
      project_points<false>(to_camera, view.camera, end - begin, points, nullptr, &projected[begin]);
    else
      project_points<true>(to_camera, view.camera, end - begin, points, surface.normals[begin].data(),
                           &projected[begin]);
  });
  std::optional<SelfOcclusion> self;
  if (options.self_occlusion_spacing_m) {
    // What hides a pixel projects to it. A point beside the image can be so near that its cells hold the whole image.
    for (ProjectedPoint& p : projected)
      if (!view.camera.contains({p.u, p.v})) p.z = -1;
    self.emplace(projected, static_cast<float>(view.camera.fx), static_cast<float>(*options.self_occlusion_spacing_m));
  }

  const auto min_cosine = static_cast<float>(options.min_viewing_cosine);
  SurfaceEvidence result;
  result.points.assign(num, Evidence::kUnobserved);
  result.viewing_cosine.resize(num);
  const auto classify = [&](std::size_t i) {
    const ProjectedPoint& p = projected[i];
    result.viewing_cosine[i] = p.viewing_cosine;
    if (p.viewing_cosine < min_cosine || !(p.z > 0)) return;
    const Evidence evidence =
        classify_at(view.camera.pixel_at({p.u, p.v}), p.z, view, options.margin, options.window_radius_px);
    result.points[i] = self && self->hides(p) ? Evidence::kOccluded : evidence;
  };
  parallel_for_blocks(num, kPointsPerTask, options.num_threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) classify(i);
  });
  for (std::size_t i = 0; i < result.points.size(); ++i)
    if (!(result.viewing_cosine[i] < min_cosine)) ++result.count[static_cast<std::size_t>(result.points[i])];
  return result;
}

}  // namespace resight
