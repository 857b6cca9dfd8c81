// SPDX-License-Identifier: Apache-2.0
// Changes and reconstruction.
#include <benchmark/benchmark.h>

#include "demo_scene.hpp"
#include "resight/changes/difference.hpp"
#include "resight/changes/view_difference.hpp"
#include "resight/recognition/stage_options.hpp"

namespace resight::bench {
namespace {

const PreparedView& last_view() { return demo_scene().views.back(); }

/// Psi in the camera frame of the last view.
const PointCloud& previous_in_camera() {
  static const PointCloud kCloud =
      transform(last_view().frame.world_from_camera.inverse(), demo_scene().scene->reconstruction());
  return kCloud;
}

/// Eq. (2) from Psi to the view, by projection into the image. Items: points.
void DifferenceToView(benchmark::State& state) {
  const auto& points = previous_in_camera().points;
  for (auto _ : state)
    benchmark::DoNotOptimize(find_explained_points(points, last_view().cloud, last_view().frame.camera, {}));
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(points.size()));
}
BENCHMARK(DifferenceToView)->Unit(benchmark::kMillisecond);

/// Same for any two clouds, with a grid of cells (rebuilt each time): the peer of the projection.
void DifferenceOfClouds(benchmark::State& state) {
  const auto& points = previous_in_camera().points;
  const PointCloud view = to_point_cloud(last_view().cloud, nullptr, false);
  for (auto _ : state) benchmark::DoNotOptimize(subtract_clouds(points, view.points, 0.02));
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(points.size()));
}
BENCHMARK(DifferenceOfClouds)->Unit(benchmark::kMillisecond);

/// Alg. 1, lines 1 to 3, and the novel points. Argument: threads.
void DetectChanges(benchmark::State& state) {
  const DemoScene& demo = demo_scene();
  DetectChangesOptions options = demo.config.changes.detection;
  options.num_threads = static_cast<int>(state.range(0));
  std::vector<const PreparedView*> earlier;
  for (const DynamicScene::View& view : demo.scene->window()) earlier.push_back(&view.cleared);
  for (auto _ : state)
    benchmark::DoNotOptimize(
        detect_changes(demo.scene->reconstruction(), last_view(), options, earlier, demo.config.integrate.voxel_m));
  state.counters["psi"] = static_cast<double>(demo.scene->reconstruction().size());
}
BENCHMARK(DetectChanges)->Arg(1)->Arg(2)->Unit(benchmark::kMillisecond)->MeasureProcessCPUTime()->UseRealTime();

/// Reduces one view to voxels.
void ReduceToVoxels(benchmark::State& state) {
  std::size_t num_voxels = 0;
  VoxelNumbers numbers;
  for (auto _ : state) num_voxels = reduce_to_voxels(last_view(), numbers).order.size();
  state.counters["voxels"] = static_cast<double>(num_voxels);
}
BENCHMARK(ReduceToVoxels)->Unit(benchmark::kMillisecond);

/// Merges the views of a window into one cloud. Argument: views.
void MergeVoxels(benchmark::State& state) {
  VoxelNumbers numbers;
  std::vector<ViewVoxels> voxels;
  for (std::int64_t v = 0; v < state.range(0); ++v)
    voxels.push_back(reduce_to_voxels(demo_scene().views[static_cast<std::size_t>(v)], numbers));
  std::vector<const ViewVoxels*> views;
  for (const ViewVoxels& v : voxels) views.push_back(&v);
  VoxelMerger merger;
  Reconstruction result;
  for (auto _ : state) merger.merge(views, {}, result);
  state.counters["points"] = static_cast<double>(result.cloud_in_world.size());
}
BENCHMARK(MergeVoxels)->Arg(1)->Arg(3)->Arg(6)->Unit(benchmark::kMillisecond);

/// Changes and reconstruction of all seven views. Argument: threads.
void AlgorithmOne(benchmark::State& state) {
  const DemoScene& demo = demo_scene();
  RecognizerConfig config = demo.config;
  config.set_num_threads(static_cast<int>(state.range(0)));
  for (auto _ : state) {
    DynamicScene scene(scene_options(config));
    for (const PreparedView& view : demo.views) benchmark::DoNotOptimize(scene.add_view(view));
  }
  state.counters["s_per_view"] =
      benchmark::Counter(static_cast<double>(demo.views.size()),
                         benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}
BENCHMARK(AlgorithmOne)->Arg(1)->Arg(2)->Unit(benchmark::kMillisecond)->MeasureProcessCPUTime()->UseRealTime();

}  // namespace
}  // namespace resight::bench
