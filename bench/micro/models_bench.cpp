// SPDX-License-Identifier: Apache-2.0
// Training and the library file.
#include <benchmark/benchmark.h>

#include <filesystem>

#include "demo_scene.hpp"
#include "resight/models/library_file.hpp"
#include "resight/training/training.hpp"

namespace resight::bench {
namespace {

/// One object from its mesh, including views and symmetries. Argument: threads.
void TrainObject(benchmark::State& state) {
  const ProceduralObject& object = demo_scene().objects.front();
  TrainOptions options;
  options.num_threads = static_cast<int>(state.range(0));
  for (auto _ : state) benchmark::DoNotOptimize(train_object(object.name, object.mesh, options).ok());
}
BENCHMARK(TrainObject)->Arg(1)->Arg(2)->Unit(benchmark::kMillisecond)->MeasureProcessCPUTime()->UseRealTime();

void LoadLibrary(benchmark::State& state) {
  const DemoScene& demo = demo_scene();
  const std::filesystem::path path = std::filesystem::temp_directory_path() / "resight_bench_micro.resight";
  if (!save_library(demo.library, path).ok()) return state.SkipWithError("the library cannot be written");
  for (auto _ : state) benchmark::DoNotOptimize(load_library(path).ok());
  state.SetBytesProcessed(state.iterations() * static_cast<std::int64_t>(std::filesystem::file_size(path)));
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(demo.library.objects.size()));
  std::filesystem::remove(path);
}
BENCHMARK(LoadLibrary)->Unit(benchmark::kMillisecond);

/// Index over the descriptors of all models.
void IndexLibrary(benchmark::State& state) {
  const DemoScene& demo = demo_scene();
  std::int64_t num_descriptors = 0;
  for (const ObjectModel& object : demo.library.objects)
    num_descriptors += static_cast<std::int64_t>(object.sift.size() + object.shot.size());
  for (auto _ : state) {
    const ModelFeatureIndex index(demo.library, demo.config.features.match);
    benchmark::DoNotOptimize(&index);
  }
  state.SetItemsProcessed(state.iterations() * num_descriptors);
}
BENCHMARK(IndexLibrary)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace resight::bench
