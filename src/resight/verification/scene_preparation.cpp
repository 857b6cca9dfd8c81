// SPDX-License-Identifier: Apache-2.0
#include "resight/verification/scene_preparation.hpp"

#include <algorithm>
#include <utility>

#include "resight/core/parallel.hpp"
#include "resight/geometry/triangle_mesh.hpp"
#include "resight/models/shape_symmetry_motions.hpp"

namespace resight {
namespace {

constexpr double kBlock_m = 0.06;    // Granularity of the lookup of surroundings: affects speed only.
constexpr float kCropCube_m = 0.1F;  // Coarse: the cubes of all hypotheses are listed.

PointCloud keep_finite(const PointCloud& cloud) {
  std::vector<int> finite;
  finite.reserve(cloud.size());
  for (std::size_t i = 0; i < cloud.size(); ++i)
    if (cloud.points[i].allFinite()) finite.push_back(static_cast<int>(i));
  PointCloud result = select(cloud, finite);
  for (Eigen::Vector3f& n : result.normals)
    if (!n.allFinite()) n.setZero();
  return result;
}

FindPlanesOptions find_planes_options(const VerifyOptions& options) {
  return {.max_distance_m = options.planes->max_distance_m, .num_threads = options.num_threads};
}

// Whether planes are found in the scene downsampled further, without smooth segments.
bool finds_planes_apart(const VerifyOptions& options) {
  return std::holds_alternative<ContinuationClutter>(options.clutter.rule) && options.planes &&
         options.planes->spacing_m.value_or(0) > options.resolution_m;
}

bool needs_segments(const VerifyOptions& options) {
  return std::holds_alternative<SegmentClutter>(options.clutter.rule) ||
         (options.planes && !finds_planes_apart(options));
}

// In the scene downsampled further: planes are large.
std::vector<ScenePlane> find_planes_quickly(std::span<const Eigen::Vector3f> points,
                                            std::span<const Eigen::Vector3f> normals, const VerifyOptions& options) {
  PointCloud cloud;
  cloud.points.assign(points.begin(), points.end());
  cloud.normals.assign(normals.begin(), normals.end());
  const double spacing_m = *options.planes->spacing_m;
  cloud = voxel_downsample(cloud, spacing_m);
  return find_planes_of_downsampled(cloud.points, cloud.normals, spacing_m, find_planes_options(options)).planes;
}

// All but the segments and planes.
PreparedScene without_surfaces(PointCloud cloud, const VerifyOptions& options) {
  if (!is_downsampled(cloud, options.resolution_m)) cloud = voxel_downsample(cloud, options.resolution_m);
  PreparedScene scene;
  if (options.appearance.use_color && cloud.has_colors()) {
    scene.linear_light = to_linear_light(cloud.colors);
    scene.lab = to_lab(scene.linear_light);
  }
  scene.points = std::move(cloud.points);
  scene.normals = std::move(cloud.normals);
  scene.segment.assign(scene.points.size(), -1);
  scene.plane.assign(scene.points.size(), -1);
  scene.blocks = BlockGrid(scene.points, kBlock_m);
  return scene;
}

void find_surfaces(PreparedScene& scene, const VerifyOptions& options) {
  SmoothSegments segments = find_smooth_segments(scene.points, scene.normals, {.num_threads = options.num_threads});
  scene.num_segments = segments.num_segments;
  if (options.planes) {
    ScenePlanes planes =
        find_scene_planes(scene.points, scene.normals, segments, options.resolution_m, find_planes_options(options));
    scene.planes = std::move(planes.planes);
    scene.plane = std::move(planes.plane_of_point);
  }
  scene.segment = std::move(segments.segment);
}

}  // namespace

PointCloud crop_to_balls(const PointCloud& cloud, std::span<const Ball> balls) {
  VoxelMap cubes;
  std::vector<Eigen::Vector3i> corners;
  std::vector<int> cube_of_point(cloud.size(), VoxelMap::kNotFound);
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    if (!cloud.points[i].allFinite()) continue;
    const Eigen::Vector3i corner = voxel_index(cloud.points[i], 1 / kCropCube_m);
    cube_of_point[i] = cubes.insert(voxel_key(corner.x(), corner.y(), corner.z()));
    if (cube_of_point[i] == static_cast<int>(corners.size())) corners.push_back(corner);
  }
  // A large object reaches more cubes than there are occupied ones.
  std::vector<std::uint8_t> is_near(corners.size(), 0);
  for (const Ball& ball : balls) {
    const Eigen::Array3i first = voxel_index(ball.center.array() - ball.radius_m, 1 / kCropCube_m);
    const Eigen::Array3i last = voxel_index(ball.center.array() + ball.radius_m, 1 / kCropCube_m);
    for (std::size_t c = 0; c < corners.size(); ++c)
      if ((corners[c].array() >= first).all() && (corners[c].array() <= last).all()) is_near[c] = 1;
  }
  std::vector<int> kept;
  for (std::size_t i = 0; i < cloud.size(); ++i)
    if (cube_of_point[i] >= 0 && is_near[static_cast<std::size_t>(cube_of_point[i])] != 0)
      kept.push_back(static_cast<int>(i));
  return select(cloud, kept);
}

PreparedScene prepare_scene(const PointCloud& scene_in_world, const VerifyOptions& options) {
  PointCloud cloud = keep_finite(scene_in_world);
  if (!cloud.has_normals() || !finds_planes_apart(options)) {
    PreparedScene scene = without_surfaces(std::move(cloud), options);
    if (needs_segments(options) && !scene.normals.empty()) find_surfaces(scene, options);
    return scene;
  }
  // Mostly it is downsampled already: then its planes are those of the cloud, which need not wait for the rest.
  PreparedScene scene;
  std::vector<ScenePlane> planes;
  run_both(
      options.num_threads, [&] { planes = find_planes_quickly(cloud.points, cloud.normals, options); },
      [&] { scene = without_surfaces(cloud, options); });
  const bool was_downsampled = scene.points.size() == cloud.points.size();
  scene.planes = was_downsampled ? std::move(planes) : find_planes_quickly(scene.points, scene.normals, options);
  scene.plane = assign_to_planes(scene.points, scene.normals, scene.planes, find_planes_options(options));
  return scene;
}

PreparedModel prepare_model(const ObjectModel& model, const VerifyOptions& options, bool as_grey) {
  PointCloud downsampled = voxel_downsample(model.surface, options.resolution_m);
  if (as_grey)
    std::ranges::transform(downsampled.colors, downsampled.colors.begin(), [](Rgb8 c) { return to_grey(c); });
  PreparedModel prepared;
  if (options.appearance.use_color && downsampled.has_colors()) {
    prepared.linear_light = to_linear_light(downsampled.colors);
    prepared.lab = to_lab(prepared.linear_light);
    if (options.refine.symmetry_step_rad)
      prepared.symmetry_motions = shape_symmetry_motions(model, *options.refine.symmetry_step_rad);
  }
  prepared.points = std::move(downsampled.points);
  prepared.normals = std::move(downsampled.normals);
  if (prepared.symmetry_motions.size() > 1)
    prepared.nearest = NearestPointMap(prepared.points, 2 * static_cast<float>(options.support.max_distance_m),
                                       0.5F * static_cast<float>(options.resolution_m));
  prepared.center = centroid(prepared.points);
  prepared.diameter_m = model.diameter_m > 0 ? model.diameter_m : diameter(prepared.points);
  return prepared;
}

}  // namespace resight
