// SPDX-License-Identifier: Apache-2.0
#include "resight/shape_search/scene_samples.hpp"

#include <algorithm>

#include "resight/core/check.hpp"
#include "resight/core/random.hpp"
#include "resight/geometry/kd_tree.hpp"
#include "resight/segmentation/noisy_planes.hpp"
#include "resight/sensor/noise_model.hpp"

namespace resight {
namespace {

constexpr double kSpacingStep = 1.15;    // A quarter fewer points per step.
constexpr int kMaxSpacingSteps = 40;     // 270 times the first.
constexpr float kSimilarNormals = 0.3F;  // Cosine; below: the other side of a thin wall, or another face.

PointCloud near_points(const PreparedView& view, const SampleSceneOptions& options) {
  std::vector<int> pixels;
  const PointCloud all = to_point_cloud(view.cloud, &view.surface_color(), true, &pixels);
  std::vector<int> kept;
  for (std::size_t i = 0; i < all.size(); ++i)
    if (all.points[i].z() <= static_cast<float>(options.max_depth_m) &&
        view.edge_distance_px[static_cast<std::size_t>(pixels[i])] >= static_cast<float>(options.min_edge_distance_px))
      kept.push_back(static_cast<int>(i));
  return voxel_downsample(select(all, kept), options.spacing_m);
}

// The noise of each point, seen from the front.
std::vector<float> noise_of(const PointCloud& cloud, const DepthNoise& noise) {
  std::vector<float> noise_m;
  noise_m.reserve(cloud.size());
  for (const Eigen::Vector3f& p : cloud.points)
    noise_m.push_back(static_cast<float>(axial_noise_m(noise, static_cast<double>(p.z()))));
  return noise_m;
}

SceneSamples without_large_planes(const PointCloud& cloud, const SampleSceneOptions& options, double max_plane_m,
                                  const DepthNoise& noise) {
  ScenePlanes planes =
      find_planes_of_downsampled(cloud.points, cloud.normals, options.spacing_m, {.num_threads = options.num_threads});
  std::vector<int> kept;
  std::vector<int> off_planes;  // Those of smaller planes stay what they are: the faces of boxes.
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const int plane = planes.plane_of_point[i];
    if (plane >= 0 && planes.planes[static_cast<std::size_t>(plane)].extent_m > static_cast<float>(max_plane_m))
      continue;
    kept.push_back(static_cast<int>(i));
    if (plane < 0) off_planes.push_back(static_cast<int>(i));
  }
  const std::vector<float> noise_m = noise_of(cloud, noise);
  for (ScenePlane& plane : find_noisy_planes(cloud.points, cloud.normals, noise_m, off_planes,
                                             {.min_extent_m = max_plane_m, .seed = options.seed})) {
    std::erase_if(kept, [&](int i) {
      const auto k = static_cast<std::size_t>(i);
      return planes.plane_of_point[k] < 0 &&
             plane.holds(cloud.points[k], cloud.normals[k], plane.tolerance_m(noise_m[k]), ScenePlane::kMinNoisyDot);
    });
    planes.planes.push_back(std::move(plane));
  }
  return {select(cloud, kept), std::move(planes.planes)};
}

// Greedy, in the given order.
std::vector<int> choose_apart(const PointCloud& surface, const KdTree& tree, const std::vector<int>& order,
                              double spacing_m) {
  std::vector<std::uint8_t> covered(surface.size(), 0);
  std::vector<int> chosen;
  std::vector<PointNeighbor> neighbors;
  for (const int i : order) {
    if (covered[static_cast<std::size_t>(i)] != 0) continue;
    chosen.push_back(i);
    tree.within(surface.points[static_cast<std::size_t>(i)], spacing_m, neighbors);
    for (const PointNeighbor& n : neighbors)
      if (surface.normals[static_cast<std::size_t>(i)].dot(surface.normals[static_cast<std::size_t>(n.index)]) >
          kSimilarNormals)
        covered[static_cast<std::size_t>(n.index)] = 1;
  }
  return chosen;
}

Eigen::Vector3f mean_normal(const PointCloud& surface, const KdTree& tree, int i, double radius_m,
                            std::vector<PointNeighbor>& neighbors) {
  const Eigen::Vector3f& own = surface.normals[static_cast<std::size_t>(i)];
  Eigen::Vector3f sum = own;
  tree.within(surface.points[static_cast<std::size_t>(i)], radius_m, neighbors);
  for (const PointNeighbor& n : neighbors) {
    const Eigen::Vector3f& other = surface.normals[static_cast<std::size_t>(n.index)];
    if (own.dot(other) > kSimilarNormals) sum += other;
  }
  return sum.normalized();
}

}  // namespace

SceneSamples sample_scene(const PreparedView& view, const SampleSceneOptions& options, double max_plane_m) {
  options.check();
  PointCloud cloud = near_points(view, options);
  if (!cloud.has_normals()) return {std::move(cloud), {}};
  return without_large_planes(cloud, options, max_plane_m, view.frame.camera.noise);
}

PointCloud sample_surface(const PointCloud& surface, double spacing_m, int max_points) {
  check_positive("sample_surface: spacing_m", spacing_m);
  check_positive("sample_surface: max_points", max_points);
  if (!surface.has_normals()) return {};
  const KdTree tree(surface.points);
  std::vector<int> order;
  for (std::size_t i = 0; i < surface.size(); ++i)
    if (surface.normals[i].allFinite()) order.push_back(static_cast<int>(i));
  Rng(1).shuffle(order);
  std::vector<int> chosen = choose_apart(surface, tree, order, spacing_m);
  const auto most = static_cast<std::size_t>(max_points);
  for (int step = 0; step < kMaxSpacingSteps && chosen.size() > most; ++step)
    chosen = choose_apart(surface, tree, order, spacing_m *= kSpacingStep);
  chosen.resize(std::min(chosen.size(), most));  // Normals that point apart never cover each other.
  PointCloud samples = select(surface, chosen);
  std::vector<PointNeighbor> neighbors;
  for (std::size_t i = 0; i < chosen.size(); ++i)
    samples.normals[i] = mean_normal(surface, tree, chosen[i], 0.5 * spacing_m, neighbors);
  return samples;
}

}  // namespace resight
