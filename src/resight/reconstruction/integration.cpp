// SPDX-License-Identifier: Apache-2.0
#include "resight/reconstruction/integration.hpp"

#include <algorithm>
#include <numeric>

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

/// Not inlined: a point must round to the same place when its voxel is found and when it is kept.
[[gnu::noinline]] Eigen::Vector3f point_in_world(const Rigid3f& world_from_camera, const OrganizedCloud& cloud,
                                                 std::size_t i) {
  return world_from_camera * cloud.point(i);
}

/// Best pixel of each voxel.
struct Winners {
  std::vector<int> pixels;
  std::vector<float> noise;
  std::vector<int> num_points;

  [[nodiscard]] std::size_t size() const { return pixels.size(); }
  void add(std::size_t number, int pixel, float pixel_noise) {
    if (number == pixels.size()) {
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

bool takes_part(const PreparedView& view, std::size_t i, const IntegrateOptions& options) {
  return view.cloud.has_normal(i) && view.cloud.has_point(i) &&
         !(view.edge_distance_px[i] < static_cast<float>(options.min_edge_distance_px));
}

/// `number_of(pixel)`: of its voxel, in the order of their first pixels. Fills `voxel_of_pixel`.
template <typename NumberOf>
Winners find_winners(const PreparedView& view, const IntegrateOptions& options, std::vector<int>& voxel_of_pixel,
                     NumberOf&& number_of) {
  const OrganizedCloud& cloud = view.cloud;
  Winners winners;
  voxel_of_pixel.assign(cloud.z.size(), VoxelMap::kNotFound);
  for (std::size_t i = 0; i < cloud.z.size(); ++i) {
    if (!takes_part(view, i, options)) continue;
    const int number = number_of(i);
    const float lateral_m = view.noise.lateral_m[i];
    winners.add(static_cast<std::size_t>(number), static_cast<int>(i), lateral_m * lateral_m * view.noise.axial_m[i]);
    voxel_of_pixel[i] = number;
  }
  return winners;
}

void keep_winners(const PreparedView& view, Winners winners, ViewVoxels& result) {
  result.noise = std::move(winners.noise);
  result.num_points = std::move(winners.num_points);
  const Rigid3f world_from_camera(view.frame.world_from_camera);
  PointCloud& cloud_in_world = result.cloud_in_world;
  cloud_in_world.points.reserve(winners.pixels.size());
  cloud_in_world.normals.reserve(winners.pixels.size());
  cloud_in_world.colors.reserve(winners.pixels.size());
  for (const int pixel : winners.pixels) {
    const auto i = static_cast<std::size_t>(pixel);
    cloud_in_world.points.push_back(point_in_world(world_from_camera, view.cloud, i));
    cloud_in_world.normals.push_back(world_from_camera.rotation * view.cloud.normal(i));
    cloud_in_world.colors.push_back(view.frame.color[i]);
  }
}

/// The numbers of voxels that were numbered before; none at all if others have come.
void keep_numbers(const ViewVoxels& before, const std::vector<int>& number_of_slot, ViewVoxels& result) {
  const std::size_t num_before = before.keys.size();
  if (before.numbers.empty() || std::any_of(number_of_slot.begin() + static_cast<std::ptrdiff_t>(num_before),
                                            number_of_slot.end(), [](int n) { return n != VoxelMap::kNotFound; }))
    return;
  result.numbers.resize(result.keys.size());
  for (std::size_t old = 0; old < num_before; ++old)
    if (number_of_slot[old] != VoxelMap::kNotFound)
      result.numbers[static_cast<std::size_t>(number_of_slot[old])] = before.numbers[old];
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
  const Rigid3f world_from_camera(view.frame.world_from_camera);
  const auto inverse_size = static_cast<float>(1.0 / options.voxel_m);
  ViewVoxels result;
  VoxelMap voxels(view.cloud.z.size() / 8);
  std::uint64_t last_key = 0;
  int number = VoxelMap::kNotFound;  // neighbouring pixels often share their voxel: saves the look-up
  Winners winners = find_winners(view, options, result.voxel_of_pixel, [&](std::size_t i) {
    const std::uint64_t key = voxel_key(point_in_world(world_from_camera, view.cloud, i), inverse_size);
    if (number == VoxelMap::kNotFound || key != last_key) number = voxels.insert(key);
    last_key = key;
    if (static_cast<std::size_t>(number) == result.keys.size()) result.keys.push_back(key);
    return number;
  });
  keep_winners(view, std::move(winners), result);
  return result;
}

ViewVoxels reduce_again(const PreparedView& view, const ViewVoxels& before, const IntegrateOptions& options) {
  options.check();
  check_view(view);
  require(before.voxel_of_pixel.size() == view.cloud.z.size(), "reduce_again: not the view that was reduced before");
  const Rigid3f world_from_camera(view.frame.world_from_camera);
  const auto inverse_size = static_cast<float>(1.0 / options.voxel_m);
  const auto key_of = [&](std::size_t i) {
    return voxel_key(point_in_world(world_from_camera, view.cloud, i), inverse_size);
  };
  // An edge may go with the points of one side: then points of the other side come in, into voxels old or new.
  VoxelMap joined;
  for (std::size_t i = 0; i < view.cloud.z.size(); ++i)
    if (takes_part(view, i, options) && before.voxel_of_pixel[i] == VoxelMap::kNotFound) joined.insert(key_of(i));
  const std::size_t num_before = before.keys.size();
  std::vector<std::size_t> slot_of_joined(joined.size());
  std::iota(slot_of_joined.begin(), slot_of_joined.end(), num_before);
  for (std::size_t old = 0; joined.size() > 0 && old < num_before; ++old)
    if (const int number = joined.find(before.keys[old]); number != VoxelMap::kNotFound)
      slot_of_joined[static_cast<std::size_t>(number)] = old;

  ViewVoxels result;
  std::vector<int> number_of_slot(num_before + joined.size(), VoxelMap::kNotFound);
  Winners winners = find_winners(view, options, result.voxel_of_pixel, [&](std::size_t i) {
    const int old = before.voxel_of_pixel[i];
    const std::size_t slot = old != VoxelMap::kNotFound
                                 ? static_cast<std::size_t>(old)
                                 : slot_of_joined[static_cast<std::size_t>(joined.find(key_of(i)))];
    if (number_of_slot[slot] == VoxelMap::kNotFound) {
      number_of_slot[slot] = static_cast<int>(result.keys.size());
      result.keys.push_back(slot < num_before ? before.keys[slot] : key_of(i));
    }
    return number_of_slot[slot];
  });
  keep_numbers(before, number_of_slot, result);
  keep_winners(view, std::move(winners), result);
  return result;
}

void VoxelNumbers::assign_to(ViewVoxels& view) {
  view.numbers.clear();
  view.numbers.reserve(view.keys.size());
  for (const std::uint64_t key : view.keys) view.numbers.push_back(voxels_.insert(key));
}

Reconstruction merge_voxels(std::span<const ViewVoxels* const> views, const IntegrateOptions& options) {
  options.check();
  struct Winner {
    int view;
    int index;
    int num_points;
    float noise;
  };
  constexpr int kNone = -1;
  int num_numbers = 0;
  for (const ViewVoxels* view : views) {
    require(view != nullptr, "merge_voxels: a view is null");
    require(view->numbers.size() == view->keys.size(), "merge_voxels: the voxels of a view are not numbered");
    for (const int number : view->numbers) num_numbers = std::max(num_numbers, number + 1);
  }
  std::vector<int> winner_of(static_cast<std::size_t>(num_numbers), kNone);
  std::vector<Winner> winners;  // In the order of the voxels' first points, view by view.
  for (std::size_t v = 0; v < views.size(); ++v) {
    const ViewVoxels& view = *views[v];
    for (std::size_t i = 0; i < view.keys.size(); ++i) {
      int& w = winner_of[static_cast<std::size_t>(view.numbers[i])];
      const Winner candidate{static_cast<int>(v), static_cast<int>(i), view.num_points[i], view.noise[i]};
      if (w == kNone) {
        w = static_cast<int>(winners.size());
        winners.push_back(candidate);
        continue;
      }
      Winner& winner = winners[static_cast<std::size_t>(w)];
      const int num_points = winner.num_points + candidate.num_points;
      if (candidate.noise <= winner.noise) winner = candidate;  // ties: the later view
      winner.num_points = num_points;
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
  VoxelNumbers numbers;
  std::vector<const ViewVoxels*> pointers;
  for (ViewVoxels& v : voxels) {
    numbers.assign_to(v);
    pointers.push_back(&v);
  }
  return merge_voxels(pointers, options);
}

}  // namespace resight
