// SPDX-License-Identifier: Apache-2.0
#include "resight/modelling/fusion.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "resight/core/check.hpp"
#include "resight/core/parallel.hpp"
#include "resight/modelling/internal/distance_volume.hpp"
#include "resight/modelling/internal/surface_nets.hpp"
#include "resight/modelling/mesh_quality.hpp"
#include "resight/sensor/crop_view.hpp"
#include "resight/sensor/prepared_view.hpp"

namespace resight {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;

// Around the mask: pixels of the background give free space in front of it.
constexpr int kMargin_px = 12;
// Normals give only the incidence here, so smooth ones are preferable.
constexpr int kNormalRadius_px = 3;
// A view observes a vertex if the pixel shows a point this near.
constexpr float kSamePoint_m = 0.004F;

// Inverse variance across the surface, in 1/mm^2, times the viewing cosine.
double point_weight(const PreparedView& view, std::size_t i, double cosine) {
  const double axial_mm = 1000.0 * view.noise.axial_m[i] * cosine;
  const double lateral_mm = 1000.0 * view.noise.lateral_m[i] * std::sqrt(std::max(0.0, 1 - cosine * cosine));
  return cosine / (axial_mm * axial_mm + lateral_mm * lateral_mm);
}

FusionView make_fusion_view(const TrainingView& whole, const FuseViewsOptions& options) {
  TrainingView part = crop_to_object(whole, kMargin_px);
  FusionView result;
  if (part.mask.empty()) return result;
  result.camera_from_object = part.frame.world_from_camera.inverse();
  PrepareViewOptions prepare;
  prepare.normals.window_radius_px = kNormalRadius_px;
  PreparedView view = prepare_view(std::move(part.frame), prepare);
  result.camera = view.frame.camera;
  result.weight = Image<float>(result.camera.width, result.camera.height, 0.0F);
  result.slope = Image<float>(result.camera.width, result.camera.height, 0.0F);
  const double min_cosine = std::cos(options.max_incidence_rad);
  for (std::size_t i = 0; i < result.weight.size(); ++i) {
    if (part.mask[i] == 0 || !view.cloud.has_point(i) || !view.cloud.has_normal(i)) continue;
    if (view.edge_distance_px[i] < static_cast<float>(options.min_edge_distance_px)) continue;
    const Vector3d ray = view.cloud.point(i).cast<double>() / static_cast<double>(view.cloud.z[i]);
    const double across = -ray.dot(view.cloud.normal(i).cast<double>());
    const double cosine = across / ray.norm();
    if (cosine < min_cosine) continue;
    result.weight[i] = static_cast<float>(point_weight(view, i, cosine));
    result.slope[i] = static_cast<float>(across);
  }
  result.depth_m = std::move(view.frame.depth_m);
  result.color = std::move(view.frame.color);
  return result;
}

// Colours a vertex from the views that observe it, weighted by viewing cosine and distance. Only a range of the
// brightness distribution is used (color_from to color_to): darker observations are in shade, brighter ones are
// specular or mixed with the background. On a turntable, every side faces the lamp at some time.
class VertexPainter {
 public:
  VertexPainter(std::span<const FusionView> views, const FuseViewsOptions& options)
      : views_(views), from_(options.color_from), to_(options.color_to) {
    for (const FusionView& view : views) camera_from_object_.emplace_back(view.camera_from_object);
  }

  struct Observation {
    double weight = 0;
    Vector3d color = Vector3d::Zero();
  };

  // `observations` is overwritten; it is passed in to reuse its memory.
  [[nodiscard]] Rgb8 color(const Vector3f& p, const Vector3f& normal, std::vector<Observation>& observations) const {
    observations.clear();
    double total = 0;
    for (std::size_t k = 0; k < views_.size(); ++k)
      if (const Observation o = observe(k, p, normal); o.weight > 0) {
        observations.push_back(o);
        total += o.weight;
      }
    if (observations.empty()) return {128, 128, 128};
    std::ranges::stable_sort(observations, {}, [](const Observation& o) { return o.color.sum(); });
    Vector3d sum = Vector3d::Zero();
    double before = 0;
    for (const Observation& o : observations) {
      const double after = before + o.weight;
      const double used = std::min(after, to_ * total) - std::max(before, from_ * total);
      if (used > 0) sum += used / ((to_ - from_) * total) * o.color;
      before = after;
    }
    const auto round = [](double x) { return static_cast<std::uint8_t>(std::clamp(x + 0.5, 0.0, 255.0)); };
    return {round(sum.x()), round(sum.y()), round(sum.z())};
  }

 private:
  // Observation of the point in view k; weight 0 = none.
  [[nodiscard]] Observation observe(std::size_t k, const Vector3f& p_in_object, const Vector3f& normal) const {
    const FusionView& view = views_[k];
    const Vector3f p = camera_from_object_[k] * p_in_object;
    if (view.depth_m.empty() || p.z() <= 0) return {};
    const Eigen::Vector2d position_px = view.camera.project(p.cast<double>());
    const std::optional<Pixel> pixel = view.camera.pixel_at(position_px);
    if (!pixel || view.weight(pixel->u, pixel->v) <= 0) return {};
    const auto [u, v] = *pixel;
    if (!(std::abs(view.depth_m(u, v) - p.z()) * view.slope(u, v) < kSamePoint_m)) return {};
    const double cosine = static_cast<double>(-(camera_from_object_[k].rotation * normal).dot(p.normalized()));
    if (cosine < 0.2) return {};
    return {std::pow(cosine, 4) / static_cast<double>(p.z() * p.z()), sample(view.color, position_px)};
  }

  // Bilinear interpolation.
  static Vector3d sample(const Image<Rgb8>& image, const Eigen::Vector2d& pixel) {
    const double u = std::clamp(pixel.x(), 0.0, image.width() - 1.001);
    const double v = std::clamp(pixel.y(), 0.0, image.height() - 1.001);
    const int u0 = static_cast<int>(u);
    const int v0 = static_cast<int>(v);
    const int u1 = std::min(u0 + 1, image.width() - 1);
    const int v1 = std::min(v0 + 1, image.height() - 1);
    const auto at = [&](int x, int y) -> Vector3d {
      const Rgb8 c = image(x, y);
      return Vector3d(c.r, c.g, c.b);
    };
    const double a = u - u0;
    const double b = v - v0;
    return (1 - b) * ((1 - a) * at(u0, v0) + a * at(u1, v0)) + b * ((1 - a) * at(u0, v1) + a * at(u1, v1));
  }

  std::span<const FusionView> views_;
  double from_, to_;
  std::vector<Rigid3f> camera_from_object_;
};

void paint(TriangleMesh& mesh, std::span<const FusionView> views, const FuseViewsOptions& options) {
  const VertexPainter painter(views, options);
  mesh.colors.resize(mesh.vertices.size());
  parallel_for_blocks(mesh.vertices.size(), 1024, options.num_threads, [&](std::size_t begin, std::size_t end) {
    std::vector<VertexPainter::Observation> observations;
    for (std::size_t i = begin; i < end; ++i)
      mesh.colors[i] = painter.color(mesh.vertices[i], mesh.normals[i], observations);
  });
}

}  // namespace

void FuseViewsOptions::check() const {
  check_in_range("FuseViewsOptions.voxel_m", voxel_m, 0.0003, 0.05);
  check_in_range("FuseViewsOptions.truncation_m", truncation_m, 2 * voxel_m, 0.2);
  check_not_negative("FuseViewsOptions.min_edge_distance_px", min_edge_distance_px);
  check_in_range("FuseViewsOptions.max_incidence_rad", max_incidence_rad, 0.1, 1.5);
  check_not_negative("FuseViewsOptions.min_weight", min_weight);
  check_not_negative("FuseViewsOptions.max_free_share", max_free_share);
  check_in_range("FuseViewsOptions.color_from", color_from, 0, 0.99);
  check_in_range("FuseViewsOptions.color_to", color_to, color_from + 0.01, 1);
  check_in_range("FuseViewsOptions.min_component_share", min_component_share, 0, 1);
  check_in_range("FuseViewsOptions.num_threads", num_threads, 1, 4096);
}

TriangleMesh fuse_views(std::span<const TrainingView> views, const FuseViewsOptions& options) {
  options.check();
  std::vector<FusionView> seen(views.size());
  parallel_for(views.size(), options.num_threads,
               [&](std::size_t i) { seen[i] = make_fusion_view(views[i], options); });
  std::erase_if(seen, [](const FusionView& view) { return view.depth_m.empty(); });
  DistanceVolume volume;
  volume.voxel_m = options.voxel_m;
  volume.truncation_m = options.truncation_m;
  allocate_blocks(volume, seen);
  integrate_views(volume, seen, options.num_threads);
  TriangleMesh mesh = extract_surface_nets(volume, {.min_weight = static_cast<float>(options.min_weight),
                                                    .max_free_share = static_cast<float>(options.max_free_share)});
  mesh = keep_large_parts(mesh, options.min_component_share);
  compute_vertex_normals(mesh);
  paint(mesh, seen, options);
  return mesh;
}

}  // namespace resight
