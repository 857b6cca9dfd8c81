// SPDX-License-Identifier: Apache-2.0
#include "resight/reconstruction/integration.hpp"

#include <algorithm>

#include "resight/core/check.hpp"
#include "resight/core/parallel.hpp"
#include "resight/geometry/voxel_map.hpp"

namespace resight {
namespace {

void check_view(const PreparedView& view) {
  const std::size_t size = view.cloud.z.size();
  require(view.cloud.nx.size() == size && view.frame.color.size() == size && view.edge_distance_px.size() == size &&
              view.noise.lateral_m.size() == size && view.noise.axial_m.size() == size,
          "integrate_views: a view is not prepared (its images have not the size of its cloud, or it has no normals)");
}

/// Best pixel of each voxel.
struct Winners {
  std::vector<std::uint64_t> keys;
  std::vector<int> pixels;
  std::vector<float> noise;
  std::vector<int> num_points;

  void add(std::size_t number, std::uint64_t key, int pixel, float pixel_noise) {
    if (number == keys.size()) {
      keys.push_back(key);
      pixels.push_back(pixel);
      noise.push_back(pixel_noise);
      num_points.push_back(1);
      return;
    }
    ++num_points[number];
    if (pixel_noise < noise[number]) {
      noise[number] = pixel_noise;
      pixels[number] = pixel;
    }
  }
};

Winners find_winners(const PreparedView& view, const IntegrateOptions& options) {
  const Rigid3f world_from_camera(view.frame.world_from_camera);
  const auto inverse_size = static_cast<float>(1.0 / options.voxel_m);
  const auto min_edge_distance_px = static_cast<float>(options.min_edge_distance_px);
  const OrganizedCloud& cloud = view.cloud;
  VoxelMap voxels(cloud.z.size() / 8);
  Winners winners;
  std::uint64_t last_key = 0;
  int number = VoxelMap::kNotFound;  // neighbouring pixels often share their voxel: saves the look-up
  for (std::size_t i = 0; i < cloud.z.size(); ++i) {
    if (!cloud.has_normal(i) || !cloud.has_point(i) || view.edge_distance_px[i] < min_edge_distance_px) continue;
    const std::uint64_t key = voxel_key(world_from_camera * cloud.point(i), inverse_size);
    if (number == VoxelMap::kNotFound || key != last_key) number = voxels.insert(key);
    last_key = key;
    const float lateral_m = view.noise.lateral_m[i];
    winners.add(static_cast<std::size_t>(number), key, static_cast<int>(i),
                lateral_m * lateral_m * view.noise.axial_m[i]);
  }
  return winners;
}

}  // namespace

void IntegrateOptions::check() const {
  check_positive("IntegrateOptions.voxel_m", voxel_m);
  check_not_negative("IntegrateOptions.min_edge_distance_px", min_edge_distance_px);
  check_positive("IntegrateOptions.min_points_per_voxel", min_points_per_voxel);
  check_positive("IntegrateOptions.num_threads", num_threads);
}

ViewVoxels reduce_to_voxels(const PreparedView& view, const IntegrateOptions& options) {
  options.check();
  check_view(view);
  Winners winners = find_winners(view, options);
  ViewVoxels result;
  result.keys = std::move(winners.keys);
  result.noise = std::move(winners.noise);
  result.num_points = std::move(winners.num_points);
  const Rigid3f world_from_camera(view.frame.world_from_camera);
  PointCloud& cloud_in_world = result.cloud_in_world;
  cloud_in_world.points.reserve(winners.pixels.size());
  cloud_in_world.normals.reserve(winners.pixels.size());
  cloud_in_world.colors.reserve(winners.pixels.size());
  for (const int pixel : winners.pixels) {
    const auto i = static_cast<std::size_t>(pixel);
    cloud_in_world.points.push_back(world_from_camera * view.cloud.point(i));
    cloud_in_world.normals.push_back(world_from_camera.rotation * view.cloud.normal(i));
    cloud_in_world.colors.push_back(view.frame.color[i]);
  }
  return result;
}

Reconstruction merge_voxels(std::span<const ViewVoxels* const> views, const IntegrateOptions& options) {
  options.check();
  struct Winner {
    int view;
    int index;
    int num_points;
    float noise;
  };
  std::size_t largest = 0;
  for (const ViewVoxels* view : views) {
    require(view != nullptr, "merge_voxels: a view is null");
    largest = std::max(largest, view->keys.size());
  }
  VoxelMap voxels(largest * 2);
  std::vector<Winner> winners;
  winners.reserve(largest * 2);
  for (std::size_t v = 0; v < views.size(); ++v) {
    const ViewVoxels& view = *views[v];
    for (std::size_t i = 0; i < view.keys.size(); ++i) {
      const auto number = static_cast<std::size_t>(voxels.insert(view.keys[i]));
      const Winner candidate{static_cast<int>(v), static_cast<int>(i), view.num_points[i], view.noise[i]};
      if (number == winners.size()) {
        winners.push_back(candidate);
        continue;
      }
      const int num_points = winners[number].num_points + candidate.num_points;
      if (candidate.noise <= winners[number].noise) winners[number] = candidate;  // ties: the later view
      winners[number].num_points = num_points;
    }
  }
  std::erase_if(winners, [&](const Winner& w) { return w.num_points < options.min_points_per_voxel; });

  Reconstruction result;
  PointCloud& cloud_in_world = result.cloud_in_world;
  cloud_in_world.points.reserve(winners.size());
  cloud_in_world.normals.reserve(winners.size());
  cloud_in_world.colors.reserve(winners.size());
  result.noise.reserve(winners.size());
  result.view.reserve(winners.size());
  for (const Winner& w : winners) {
    const ViewVoxels& view = *views[w.view];
    cloud_in_world.points.push_back(view.cloud_in_world.points[w.index]);
    cloud_in_world.normals.push_back(view.cloud_in_world.normals[w.index]);
    cloud_in_world.colors.push_back(view.cloud_in_world.colors[w.index]);
    result.noise.push_back(w.noise);
    result.view.push_back(w.view);
  }
  return result;
}

Reconstruction integrate_views(std::span<const PreparedView* const> views, const IntegrateOptions& options) {
  options.check();
  for (const PreparedView* view : views) require(view != nullptr, "integrate_views: a view is null");
  std::vector<ViewVoxels> voxels(views.size());
  parallel_for(views.size(), options.num_threads,
               [&](std::size_t v) { voxels[v] = reduce_to_voxels(*views[v], options); });
  std::vector<const ViewVoxels*> pointers;
  for (const ViewVoxels& v : voxels) pointers.push_back(&v);
  return merge_voxels(pointers, options);
}

}  // namespace resight
