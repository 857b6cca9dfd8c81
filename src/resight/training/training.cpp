// SPDX-License-Identifier: Apache-2.0
#include "resight/training/training.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <optional>

#include "resight/core/parallel.hpp"
#include "resight/geometry/mesh_sampling.hpp"
#include "resight/geometry/outward_normals.hpp"
#include "resight/geometry/splat_mesh.hpp"
#include "resight/sensor/crop_view.hpp"
#include "resight/sensor/prepared_view.hpp"
#include "resight/training/surface.hpp"

namespace resight {
namespace {

constexpr double kMinDiameter_m = 0.005;
constexpr double kMaxDiameter_m = 5.0;
constexpr int kCropMargin_px = 48;            // surroundings that keypoints near the silhouette use
constexpr double kSamplesPerVoxelFace = 6.0;  // per surface_voxel_m^2: misses a face that fills its voxel once in 400

constexpr double kMinCloudSpacing_m = 0.001;  // size of a pixel of a training view; denser points only take longer
constexpr double kMaxCloudSpacings = 400.0;   // largest diameter in spacings; denser points only take longer
constexpr std::size_t kMinCloudPoints = 100;
constexpr Rgb8 kUnknownColor{128, 128, 128};

Error fail(const std::string& name, const std::string& what) { return {fmt::format("model '{}': {}", name, what)}; }

Result<void> check_diameter(const std::string& name, const char* kind, double size_m) {
  if (size_m > kMaxDiameter_m) {
    return fail(name, fmt::format("the {} is {:g} m across (expected {} to {}): it looks as if it were in millimetres",
                                  kind, size_m, kMinDiameter_m, kMaxDiameter_m));
  }
  if (size_m < kMinDiameter_m) {
    return fail(name,
                fmt::format("the {} is only {:g} m across (expected {} to {}): metres are needed, this looks like "
                            "another unit",
                            kind, size_m, kMinDiameter_m, kMaxDiameter_m));
  }
  return {};
}

}  // namespace

Result<void> check_training_input(const std::string& name, std::span<const TrainingView> views) {
  if (views.empty()) return fail(name, "no training views");
  bool any_object_pixel = false;
  for (const TrainingView& view : views) {
    const Result<void> frame = check_frame(view.frame);
    if (!frame.ok()) return fail(name, frame.error().message);
    if (view.mask.width() != view.frame.camera.width || view.mask.height() != view.frame.camera.height) {
      return fail(
          name, fmt::format("view '{}': the mask is {}x{}, but the image is {}x{}", view.frame.name, view.mask.width(),
                            view.mask.height(), view.frame.camera.width, view.frame.camera.height));
    }
    any_object_pixel = any_object_pixel || std::ranges::any_of(view.mask.data(), [](std::uint8_t m) { return m != 0; });
  }
  if (!any_object_pixel) return fail(name, "the masks of all training views are empty");
  return {};
}

Result<void> check_training_input(const std::string& name, const TriangleMesh& mesh) {
  if (mesh.empty()) return fail(name, "the mesh has no triangles");
  const int num_vertices = static_cast<int>(mesh.vertices.size());
  for (const auto& f : mesh.faces)
    for (const int v : f) {
      if (v < 0 || v >= num_vertices) {
        return fail(name, fmt::format("a triangle refers to vertex {}, but the mesh has {} vertices", v, num_vertices));
      }
      if (!mesh.vertices[v].allFinite()) return fail(name, fmt::format("vertex {} of the mesh is not finite", v));
    }
  const std::vector<Eigen::Vector3f> used = used_vertices(mesh);
  if (used.empty()) return fail(name, "the triangles of the mesh have no area");
  return check_diameter(name, "mesh", diameter(used));
}

Result<void> check_training_input(const std::string& name, const PointCloud& cloud) {
  if (cloud.size() < kMinCloudPoints)
    return fail(name, fmt::format("only {} points (expected {} or more)", cloud.size(), kMinCloudPoints));
  if (!std::ranges::all_of(cloud.points, [](const Eigen::Vector3f& p) { return p.allFinite(); }))
    return fail(name, "a point is not finite");
  return check_diameter(name, "cloud", diameter(cloud.points));
}

namespace {

// No sensor measures the same colour everywhere: such colours were set by hand or by default.
bool has_measured_color(std::span<const TrainingView> views) {
  std::optional<Rgb8> first;
  for (const TrainingView& view : views)
    for (std::size_t i = 0; i < view.mask.size(); ++i) {
      if (view.mask[i] == 0) continue;
      if (first && !(view.frame.color[i] == *first)) return true;
      first = view.frame.color[i];
    }
  return false;
}

bool has_measured_color(const PointCloud& cloud) {
  return cloud.has_colors() &&
         !std::ranges::all_of(cloud.colors, [&](const Rgb8& c) { return c == cloud.colors.front(); });
}

// A single colour of a mesh is valid, because its author chose it.
bool has_color(const TriangleMesh& mesh) { return mesh.has_texture() || mesh.colors.size() == mesh.vertices.size(); }

struct ViewPart {
  ObjectFeatures features;
  SurfaceSamples samples;
};

ViewPart process_view(const TrainingView& whole_view, const TrainOptions& options, bool with_surface) {
  const TrainingView view = crop_to_object(whole_view, kCropMargin_px);
  ViewPart part;
  if (view.mask.empty()) return part;
  const PreparedView prepared = prepare_view(view.frame);
  const Rigid3& object_from_camera = view.frame.world_from_camera;
  ShotOptions shot = options.shot;
  shot.num_threads = 1;  // the views already run in parallel
  part.features.sift = transform(object_from_camera, extract_sift(prepared, options.sift, &view.mask));
  part.features.shot = transform(object_from_camera, extract_shot(prepared, shot, &view.mask));
  if (with_surface) part.samples = collect_surface_samples(prepared, view.mask, options.min_edge_distance_px);
  return part;
}

// Processes all views in parallel and joins the results in order.
ViewPart process_views(std::span<const TrainingView> views, const TrainOptions& options, bool with_surface) {
  std::vector<ViewPart> parts(views.size());
  parallel_for(views.size(), options.num_threads,
               [&](std::size_t i) { parts[i] = process_view(views[i], options, with_surface); });
  ViewPart joined = std::move(parts.front());
  for (std::size_t i = 1; i < parts.size(); ++i) {
    joined.features.sift.append(parts[i].features.sift);
    joined.features.shot.append(parts[i].features.shot);
    joined.samples.cloud.append(parts[i].samples.cloud);
    joined.samples.sigma_m.insert(joined.samples.sigma_m.end(), parts[i].samples.sigma_m.begin(),
                                  parts[i].samples.sigma_m.end());
    parts[i] = {};
  }
  return joined;
}

Result<ObjectFeatures> reduce_features(const std::string& name, ObjectFeatures features, bool color_is_known,
                                       const TrainOptions& options) {
  if (!color_is_known) features.sift = ObjectFeatures{}.sift;  // would describe only shading and silhouettes
  if (features.sift.size() + features.shot.size() == 0) {
    return fail(name, fmt::format("no SIFT and no SHOT feature in any training view, so it cannot be recognised{}",
                                  color_is_known ? "" : " (its colours are unknown)"));
  }
  return ObjectFeatures{merge_similar_features(features.sift, options.sift_merging, options.num_threads),
                        merge_similar_features(features.shot, options.shot_merging, options.num_threads)};
}

ObjectModel make_model(const std::string& name, const ObjectFeatures& features, PointCloud surface) {
  ObjectModel model;
  model.name = name;
  model.sift = encode(features.sift);
  model.shot = encode(features.shot);
  model.surface = std::move(surface);
  model.center = centroid(model.surface.points);
  model.diameter_m = diameter(model.surface.points);
  return model;
}

std::vector<TrainingView> render_views(const TriangleMesh& mesh, const TrainOptions& options) {
  TurntableOptions turntable = options.turntable;
  turntable.num_threads = options.num_threads;
  return render_turntable(mesh, turntable);
}

// Extracts features from views of a mesh. SIFT is used only if the surface has colours.
Result<ObjectModel> train_from_renderings(const std::string& name, const TriangleMesh& mesh, PointCloud surface,
                                          const TrainOptions& options) {
  const std::vector<TrainingView> views = render_views(mesh, options);
  const Result<void> checked = check_training_input(name, views);
  if (!checked.ok()) return checked.error();
  Result<ObjectFeatures> features =
      reduce_features(name, process_views(views, options, false).features, surface.has_colors(), options);
  if (!features.ok()) return features.error();
  return make_model(name, *features, std::move(surface));
}

// Downsamples a cloud evenly, orients its normals outwards, and adds grey colours if there are none.
Result<PointCloud> prepare_cloud(const std::string& name, const PointCloud& cloud, int num_threads) {
  const Result<void> checked = check_training_input(name, cloud);
  if (!checked.ok()) return checked.error();
  PointCloud even = voxel_downsample(cloud, std::max(kMinCloudSpacing_m, diameter(cloud.points) / kMaxCloudSpacings));
  if (even.size() < kMinCloudPoints) return fail(name, "most of the points coincide");
  if (!even.has_colors()) even.colors.assign(even.size(), kUnknownColor);
  if (even.has_normals())
    turn_outwards(even.points, even.normals);
  else
    even.normals = estimate_outward_normals(even.points, {.num_threads = num_threads});
  return even;
}

PointCloud fuse_evenly(PointCloud cloud, double voxel_size_m) {
  SurfaceSamples samples{.cloud = std::move(cloud), .sigma_m = {}};
  samples.sigma_m.assign(samples.cloud.size(), 1.0F);
  return fuse_surface(samples, voxel_size_m);
}

}  // namespace

Result<ObjectFeatures> train_features(const std::string& name, std::span<const TrainingView> views,
                                      const TrainOptions& options) {
  options.check();
  const Result<void> checked = check_training_input(name, views);
  if (!checked.ok()) return checked.error();
  return reduce_features(name, process_views(views, options, false).features, has_measured_color(views), options);
}

Result<PointCloud> train_surface(const std::string& name, const TriangleMesh& mesh, const TrainOptions& options) {
  options.check();
  const Result<void> checked = check_training_input(name, mesh);
  if (!checked.ok()) return checked.error();
  const double voxel_face = options.surface_voxel_m * options.surface_voxel_m;
  PointCloud samples = sample_surface(mesh, kSamplesPerVoxelFace / voxel_face);
  if (samples.empty()) return fail(name, "the triangles of the mesh have no area");
  PointCloud surface = fuse_evenly(std::move(samples), options.surface_voxel_m);
  if (!has_color(mesh)) surface.colors.clear();
  return surface;
}

Result<PointCloud> train_surface(const std::string& name, const PointCloud& cloud, const TrainOptions& options) {
  options.check();
  Result<PointCloud> even = prepare_cloud(name, cloud, options.num_threads);
  if (!even.ok()) return even;
  PointCloud surface = fuse_evenly(*std::move(even), options.surface_voxel_m);
  if (!cloud.has_colors()) surface.colors.clear();
  return surface;
}

Result<ObjectModel> train_object(const std::string& name, std::span<const TrainingView> views,
                                 const TrainOptions& options) {
  options.check();
  const Result<void> checked = check_training_input(name, views);
  if (!checked.ok()) return checked.error();
  const ViewPart joined = process_views(views, options, true);
  if (joined.samples.cloud.empty()) {
    return fail(name, "no object pixel of any training view has depth, a normal and a distance from depth edges");
  }
  const bool color_is_known = has_measured_color(views);
  Result<ObjectFeatures> features = reduce_features(name, joined.features, color_is_known, options);
  if (!features.ok()) return features.error();
  PointCloud surface = fuse_surface(joined.samples, options.surface_voxel_m);
  if (!color_is_known) surface.colors.clear();
  return make_model(name, *features, std::move(surface));
}

Result<ObjectModel> train_object(const std::string& name, const TriangleMesh& mesh, const TrainOptions& options) {
  Result<PointCloud> surface = train_surface(name, mesh, options);
  if (!surface.ok()) return surface.error();
  Result<ObjectModel> model = train_from_renderings(name, mesh, *std::move(surface), options);
  if (model.ok()) model->diameter_m = diameter(used_vertices(mesh));
  return model;
}

Result<ObjectModel> train_object(const std::string& name, const PointCloud& cloud, const TrainOptions& options) {
  options.check();
  Result<PointCloud> even = prepare_cloud(name, cloud, options.num_threads);
  if (!even.ok()) return even.error();
  const TriangleMesh splats = make_splat_mesh(*even, {.num_threads = options.num_threads});
  PointCloud surface = fuse_evenly(*std::move(even), options.surface_voxel_m);
  if (!has_measured_color(cloud)) surface.colors.clear();
  return train_from_renderings(name, splats, std::move(surface), options);
}

}  // namespace resight
