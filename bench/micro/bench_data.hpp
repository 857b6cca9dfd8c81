// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <vector>

#include "resight/sensor/rgbd_frame.hpp"

/// Input of the benchmarks, generated from seeds: the same on every machine.
namespace resight::bench {

/// A VGA view of a textured table with balls of 4 to 9 cm on it, with sensor noise and missing pixels.
[[nodiscard]] RgbdFrame make_table_frame();

/// Unit vectors in families (5,000 random centres with deviations): clustered like descriptors, but without their low
/// intrinsic dimension, on which kd-trees rely. `seed` draws the members.
[[nodiscard]] std::vector<float> make_descriptors(int count, int dimension, std::uint64_t seed);

inline constexpr int kNumModelDescriptors = 200000;
inline constexpr int kNumQueries = 2000;

/// Indexed set and queries of one dimension, and the nearest neighbour of each query by exact search.
struct MatchingTask {
  std::vector<float> model;
  std::vector<float> queries;
  std::vector<int> nearest;
};
[[nodiscard]] const MatchingTask& matching_task(int dimension);

/// Share of queries whose first match is the true nearest neighbour. index_of(matches, q): that of query q.
template <typename Matches, typename IndexOf>
double recall(const MatchingTask& task, const Matches& matches, IndexOf&& index_of) {
  int hits = 0;
  for (std::size_t q = 0; q < task.nearest.size(); ++q) hits += index_of(matches, q) == task.nearest[q] ? 1 : 0;
  return static_cast<double>(hits) / static_cast<double>(task.nearest.size());
}

}  // namespace resight::bench
