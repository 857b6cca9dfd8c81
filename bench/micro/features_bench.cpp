// SPDX-License-Identifier: Apache-2.0
#include <benchmark/benchmark.h>

#include <opencv2/core.hpp>

#include "bench_data.hpp"
#include "resight/features/descriptor_index.hpp"
#include "resight/features/internal/interleaved_rows.hpp"
#include "resight/features/shot.hpp"
#include "resight/features/sift.hpp"

namespace resight::bench {
namespace {

const PreparedView& view() {
  static const PreparedView kView = prepare_view(make_table_frame());
  return kView;
}

/// OpenCV's SIFT on one thread, including 3-D points.
void Sift(benchmark::State& state) {
  const int num_threads_before = cv::getNumThreads();
  cv::setNumThreads(1);
  std::size_t num_keypoints = 0;
  for (auto _ : state) num_keypoints = extract_sift(view()).size();
  cv::setNumThreads(num_threads_before);
  state.counters["keypoints"] = static_cast<double>(num_keypoints);
}
BENCHMARK(Sift)->Unit(benchmark::kMillisecond);

/// Description only, without sampling and without the plane test. Argument: support radius, mm. Items: keypoints.
void ShotPerKeypoint(benchmark::State& state) {
  ShotOptions options{.support_radius_m = static_cast<double>(state.range(0)) / 1000, .min_surface_variation = 0};
  const FeatureSet all = extract_shot(view(), options);
  const PointCloud support = voxel_downsample(to_point_cloud(view().cloud, nullptr, true), *options.support_voxel_m);
  PointCloud keypoints;
  keypoints.points = all.points;
  keypoints.normals = all.normals;
  for (auto _ : state) benchmark::DoNotOptimize(describe_shot(support, keypoints, options));
  state.counters["keypoints"] = static_cast<double>(keypoints.size());
  state.counters["s_per_keypoint"] =
      benchmark::Counter(static_cast<double>(keypoints.size()),
                         benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}
BENCHMARK(ShotPerKeypoint)->Arg(20)->Arg(30)->Arg(40)->Unit(benchmark::kMillisecond);

/// The whole stage with default options. Argument: threads.
void ExtractShot(benchmark::State& state) {
  std::size_t num_keypoints = 0;
  for (auto _ : state) num_keypoints = extract_shot(view(), {.num_threads = static_cast<int>(state.range(0))}).size();
  state.counters["keypoints"] = static_cast<double>(num_keypoints);
}
BENCHMARK(ExtractShot)->Arg(1)->Arg(2)->Unit(benchmark::kMillisecond)->MeasureProcessCPUTime()->UseRealTime();

/// 2,000 queries against 200,000. Arguments: dimension, visited cells.
void IndexSearch(benchmark::State& state) {
  const int dimension = static_cast<int>(state.range(0));
  const MatchingTask& task = matching_task(dimension);
  const DescriptorIndex index(task.model, dimension, {.num_probes = static_cast<int>(state.range(1))});
  std::vector<DescriptorMatch> matches;
  for (auto _ : state) matches = index.search(task.queries, 1);
  state.counters["recall"] = recall(task, matches, [](const auto& found, std::size_t q) { return found[q].index; });
}
BENCHMARK(IndexSearch)->ArgsProduct({{128, 352}, {8, 16, 32, 64}})->Unit(benchmark::kMillisecond);

/// 2,000 queries against the SHOT descriptors of a single object (6,000). Argument: exact_below of the index.
void IndexSearchOfOneObject(benchmark::State& state) {
  const MatchingTask& task = matching_task(352);
  const std::span<const float> object = std::span(task.model).first(std::size_t{6000} * 352);
  const DescriptorIndex index(object, 352,
                              {.num_probes = 8, .exact_below = static_cast<int>(state.range(0)), .num_components = 64});
  for (auto _ : state) benchmark::DoNotOptimize(index.search(task.queries, 3));
}
BENCHMARK(IndexSearchOfOneObject)->Arg(1024)->Arg(8192)->Unit(benchmark::kMillisecond);

/// Products of queries with the 104 rows of a cell of 128 values, as each probe takes. Argument: queries.
void ProductsOfCell(benchmark::State& state) {
  using Matrix = InterleavedRows::Matrix;
  const InterleavedRows rows(Matrix::Random(104, 128));
  const Matrix queries = Matrix::Random(state.range(0), 128);
  Matrix products;
  for (auto _ : state) {
    rows.multiply(queries, 0, rows.size(), products);
    benchmark::DoNotOptimize(products.data());
  }
}
BENCHMARK(ProductsOfCell)->Arg(1)->Arg(5)->Arg(20)->Arg(80);

/// The same with the product of matrices of Eigen.
void ProductsOfCellByEigen(benchmark::State& state) {
  using Matrix = InterleavedRows::Matrix;
  const Matrix rows = Matrix::Random(104, 128);
  const Matrix queries = Matrix::Random(state.range(0), 128);
  Matrix products;
  for (auto _ : state) {
    products.noalias() = queries * rows.transpose();
    benchmark::DoNotOptimize(products.data());
  }
}
BENCHMARK(ProductsOfCellByEigen)->Arg(1)->Arg(5)->Arg(20)->Arg(80);

void IndexExactSearch(benchmark::State& state) {
  const int dimension = static_cast<int>(state.range(0));
  const MatchingTask& task = matching_task(dimension);
  const DescriptorIndex index(task.model, dimension, {.search = IndexSearch::kExact});
  for (auto _ : state) benchmark::DoNotOptimize(index.search(task.queries, 1));
}
BENCHMARK(IndexExactSearch)->Arg(128)->Arg(352)->Unit(benchmark::kMillisecond);

void IndexBuild(benchmark::State& state) {
  const int dimension = static_cast<int>(state.range(0));
  const MatchingTask& task = matching_task(dimension);
  for (auto _ : state) benchmark::DoNotOptimize(DescriptorIndex(task.model, dimension).size());
}
BENCHMARK(IndexBuild)->Arg(128)->Arg(352)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace resight::bench
