// SPDX-License-Identifier: Apache-2.0
#include "resight/reconstruction/integration.hpp"

#include <algorithm>

#include "resight/core/check.hpp"
#include "resight/core/parallel.hpp"

namespace resight {
namespace {

constexpr std::size_t kGrain = 16384;

void check_views(std::span<const ViewVoxels* const> views) {
  for (const ViewVoxels* view : views) {
    require(view != nullptr, "merge_voxels: a view is null");
    require(view->numbers.size() == view->keys.size(), "merge_voxels: the voxels of a view are not numbered");
  }
}

int count_numbers(std::span<const ViewVoxels* const> views) {
  int count = 0;
  for (const ViewVoxels* view : views)
    for (const int number : view->numbers) count = std::max(count, number + 1);
  return count;
}

void resize(std::size_t size, Reconstruction& result) {
  result.cloud_in_world.points.resize(size);
  result.cloud_in_world.normals.resize(size);
  result.cloud_in_world.colors.resize(size);
  result.noise.resize(size);
  result.view.resize(size);
}

}  // namespace

void VoxelMerger::find_winners(std::span<const ViewVoxels* const> views) {
  winners_.clear();
  const auto num_numbers = static_cast<std::size_t>(count_numbers(views));
  if (winner_of_number_.size() < num_numbers) winner_of_number_.resize(num_numbers);
  for (std::size_t v = 0; v < views.size(); ++v) {
    const ViewVoxels& view = *views[v];
    for (const int slot : view.order) {
      const int number = view.numbers[slot];
      int& w = winner_of_number_[number];
      const bool is_known = static_cast<std::size_t>(w) < winners_.size() && winners_[w].number == number;
      const Winner candidate{number, static_cast<int>(v), slot, view.noise[slot]};
      if (!is_known) {
        w = static_cast<int>(winners_.size());
        winners_.push_back(candidate);
      } else if (candidate.noise <= winners_[w].noise) {  // In a tie, the later view wins.
        winners_[w] = candidate;
      }
    }
  }
}

void VoxelMerger::drop_rare(std::span<const ViewVoxels* const> views, int min_points) {
  std::vector<int> num_points(winners_.size());
  for (const ViewVoxels* view : views)
    for (const int slot : view->order) num_points[winner_of_number_[view->numbers[slot]]] += view->num_points[slot];
  std::size_t position = 0;
  std::erase_if(winners_, [&](const Winner&) { return num_points[position++] < min_points; });
}

void VoxelMerger::merge(std::span<const ViewVoxels* const> views, const IntegrateOptions& options,
                        Reconstruction& result) {
  options.check();
  check_views(views);
  find_winners(views);
  if (options.min_points_per_voxel > 1) drop_rare(views, options.min_points_per_voxel);
  resize(winners_.size(), result);
  parallel_for_blocks(winners_.size(), kGrain, options.num_threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const Winner& w = winners_[i];
      const PointCloud& of_view = views[w.view]->cloud_in_world;
      result.cloud_in_world.points[i] = of_view.points[w.slot];
      result.cloud_in_world.normals[i] = of_view.normals[w.slot];
      result.cloud_in_world.colors[i] = of_view.colors[w.slot];
      result.noise[i] = w.noise;
      result.view[i] = w.view;
    }
  });
}

Reconstruction integrate_views(std::span<const PreparedView* const> views, const IntegrateOptions& options) {
  options.check();
  VoxelNumbers numbers;
  std::vector<ViewVoxels> voxels;
  for (const PreparedView* view : views) {
    require(view != nullptr, "integrate_views: a view is null");
    voxels.push_back(reduce_to_voxels(*view, numbers, options));
  }
  std::vector<const ViewVoxels*> pointers;
  for (const ViewVoxels& v : voxels) pointers.push_back(&v);
  Reconstruction result;
  VoxelMerger().merge(pointers, options, result);
  return result;
}

}  // namespace resight
