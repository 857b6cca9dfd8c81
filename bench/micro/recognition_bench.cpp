// SPDX-License-Identifier: Apache-2.0
// From features to detections, on the last view of the demo scene. Argument, if any: threads.
#include <benchmark/benchmark.h>

#include "demo_scene.hpp"
#include "resight/hypotheses/clustering.hpp"
#include "resight/recognition/view_hypothesis_generator.hpp"
#include "resight/verification/hypothesis_verifier.hpp"

namespace resight::bench {
namespace {

int threads_of(const benchmark::State& state) { return static_cast<int>(state.range(0)); }

RecognizerConfig config_of(const benchmark::State& state) {
  RecognizerConfig config = demo_scene().config;
  config.set_num_threads(threads_of(state));
  return config;
}

void MatchFeatures(benchmark::State& state) {
  const DemoScene& demo = demo_scene();
  for (auto _ : state) benchmark::DoNotOptimize(demo.index->match(demo.sift, demo.shot));
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(demo.sift.size() + demo.shot.size()));
}
BENCHMARK(MatchFeatures)->Unit(benchmark::kMillisecond);

/// Items: correspondences.
void GenerateHypotheses(benchmark::State& state) {
  const DemoScene& demo = demo_scene();
  const RecognizerConfig config = config_of(state);
  std::int64_t num_correspondences = 0;
  for (const auto& of_object : demo.correspondences) num_correspondences += static_cast<std::int64_t>(of_object.size());
  for (auto _ : state)
    benchmark::DoNotOptimize(generate_hypotheses(demo.correspondences, demo.views.back().frame.world_from_camera, 0, 0,
                                                 config.hypotheses.generate));
  state.SetItemsProcessed(state.iterations() * num_correspondences);
  state.counters["hypotheses"] = static_cast<double>(demo.hypotheses.size());
}
BENCHMARK(GenerateHypotheses)->Arg(1)->Arg(2)->Unit(benchmark::kMillisecond)->MeasureProcessCPUTime()->UseRealTime();

/// Downsampled view, its planes, and the pixel records on which poses are scored.
void SearchedViewOfView(benchmark::State& state) {
  const RecognizerConfig config = config_of(state);
  for (auto _ : state) {
    const SearchView searched(demo_scene().views.back(), config.shape, demo_scene().library.largest_diameter_m());
    benchmark::DoNotOptimize(searched.samples.points.size());
  }
}
BENCHMARK(SearchedViewOfView)->Arg(1)->Arg(2)->Unit(benchmark::kMillisecond)->MeasureProcessCPUTime()->UseRealTime();

/// Items: objects.
void ShapeSearchOfView(benchmark::State& state) {
  const DemoScene& demo = demo_scene();
  const RecognizerConfig config = config_of(state);
  const ShapeSearch shapes(demo.library, config.shape, match_criteria(config.verify));
  const SearchView searched(demo.views.back(), config.shape, demo.library.largest_diameter_m());
  std::size_t num_found = 0;
  for (auto _ : state) num_found = shapes.search(searched, demo.correspondences, demo.hypotheses).size();
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(demo.library.objects.size()));
  state.counters["candidates"] = static_cast<double>(num_found);
}
BENCHMARK(ShapeSearchOfView)->Arg(1)->Arg(2)->Unit(benchmark::kMillisecond)->MeasureProcessCPUTime()->UseRealTime();

void ClusterHypotheses(benchmark::State& state) {
  const DemoScene& demo = demo_scene();
  for (auto _ : state)
    benchmark::DoNotOptimize(cluster_hypotheses(demo.hypotheses, demo.library, *demo.config.hypotheses.cluster,
                                                demo.config.hypotheses.generate.grouping.pose));
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(demo.hypotheses.size()));
}
BENCHMARK(ClusterHypotheses)->Unit(benchmark::kMillisecond);

/// Against the reconstruction and six views. Items: hypotheses.
void VerifyHypotheses(benchmark::State& state) {
  const DemoScene& demo = demo_scene();
  const RecognizerConfig config = config_of(state);
  std::vector<VerificationView> views;
  for (const DynamicScene::View& view : demo.scene->window()) views.push_back({&view.cleared});
  std::size_t num_accepted = 0;
  HypothesisVerifier verifier(demo.library, config.verify);
  (void)verifier.verify(demo.hypotheses, demo.scene->reconstruction(), views, {});  // Models are prepared once.
  for (auto _ : state) {
    const VerifyResult result = verifier.verify(demo.hypotheses, demo.scene->reconstruction(), views, {});
    num_accepted = 0;
    for (const HypothesisEvidence& evidence : result.evidence) num_accepted += evidence.accepted ? 1 : 0;
  }
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(demo.hypotheses.size()));
  state.counters["accepted"] = static_cast<double>(num_accepted);
}
BENCHMARK(VerifyHypotheses)->Arg(1)->Arg(2)->Unit(benchmark::kMillisecond)->MeasureProcessCPUTime()->UseRealTime();

}  // namespace
}  // namespace resight::bench
