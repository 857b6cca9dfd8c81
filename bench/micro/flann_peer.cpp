// SPDX-License-Identifier: Apache-2.0
// Peer of the descriptor index: FLANN's randomised kd-trees as provided by OpenCV.
#include <benchmark/benchmark.h>

#include <opencv2/features2d.hpp>

#include "bench_data.hpp"

namespace resight::bench {
namespace {

/// 2,000 queries against 200,000 with 4 trees. Arguments: dimension, visited leaves.
void FlannSearch(benchmark::State& state) {
  const int dimension = static_cast<int>(state.range(0));
  const MatchingTask& task = matching_task(dimension);
  const auto as_matrix = [&](const std::vector<float>& values) {
    return cv::Mat(static_cast<int>(values.size()) / dimension, dimension, CV_32F, const_cast<float*>(values.data()));
  };
  cv::setRNGSeed(1);
  cv::FlannBasedMatcher matcher(cv::makePtr<cv::flann::KDTreeIndexParams>(4),
                                cv::makePtr<cv::flann::SearchParams>(static_cast<int>(state.range(1))));
  matcher.add({as_matrix(task.model)});
  matcher.train();
  std::vector<cv::DMatch> matches;
  const int num_threads_before = cv::getNumThreads();
  cv::setNumThreads(1);
  for (auto _ : state) matcher.match(as_matrix(task.queries), matches);
  cv::setNumThreads(num_threads_before);
  state.counters["recall"] = recall(task, matches, [](const auto& found, std::size_t q) { return found[q].trainIdx; });
}
BENCHMARK(FlannSearch)->ArgsProduct({{128, 352}, {32, 128, 512}})->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace resight::bench
