// SPDX-License-Identifier: Apache-2.0
#include <benchmark/benchmark.h>

#include "bench_data.hpp"
#include "resight/sensor/depth_edges.hpp"
#include "resight/sensor/noise_model.hpp"
#include "resight/sensor/organized_cloud.hpp"
#include "resight/sensor/prepared_view.hpp"

namespace resight::bench {
namespace {

const RgbdFrame& frame() {
  static const RgbdFrame kFrame = make_table_frame();
  return kFrame;
}
const PreparedView& view() {
  static const PreparedView kView = prepare_view(frame());
  return kView;
}

void BackProject(benchmark::State& state) {
  for (auto _ : state) benchmark::DoNotOptimize(back_project(frame().camera, frame().depth_m));
}
BENCHMARK(BackProject)->Unit(benchmark::kMillisecond);

/// Argument: radius of the window, px.
void Normals(benchmark::State& state) {
  OrganizedCloud cloud = back_project(frame().camera, frame().depth_m);
  for (auto _ : state) compute_normals(cloud, {.window_radius_px = static_cast<int>(state.range(0))});
}
BENCHMARK(Normals)->Arg(1)->Arg(2)->Arg(3)->Arg(4)->Unit(benchmark::kMillisecond);

void DepthEdges(benchmark::State& state) {
  for (auto _ : state) benchmark::DoNotOptimize(find_depth_edges(frame().depth_m));
}
BENCHMARK(DepthEdges)->Unit(benchmark::kMillisecond);

void EdgeDistance(benchmark::State& state) {
  const Image<std::uint8_t> edges = find_depth_edges(frame().depth_m);
  for (auto _ : state) benchmark::DoNotOptimize(find_edge_distance(edges, 5.0));
}
BENCHMARK(EdgeDistance)->Unit(benchmark::kMillisecond);

void NoiseModel(benchmark::State& state) {
  for (auto _ : state) benchmark::DoNotOptimize(model_noise(view().cloud, frame().camera));
}
BENCHMARK(NoiseModel)->Unit(benchmark::kMillisecond);

/// All steps of the preparation. Argument: threads.
void PrepareView(benchmark::State& state) {
  for (auto _ : state)
    benchmark::DoNotOptimize(prepare_view(frame(), {.num_threads = static_cast<int>(state.range(0))}));
}
BENCHMARK(PrepareView)->Arg(1)->Arg(2)->Unit(benchmark::kMillisecond)->MeasureProcessCPUTime()->UseRealTime();

}  // namespace
}  // namespace resight::bench
