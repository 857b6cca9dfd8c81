// SPDX-License-Identifier: Apache-2.0
// Limits of the machine: the first two benchmarks of a run, as a reference for all other numbers.
#include <benchmark/benchmark.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace resight::bench {
namespace {

/// Sum of an array larger than any cache: bytes per second read by one core.
void MemoryRead(benchmark::State& state) {
  constexpr std::size_t kNumFloats = std::size_t{64} << 20U;  // 256 MB
  constexpr std::size_t kLanes = 64;
  const std::vector<float> values(kNumFloats, 1.0F);
  for (auto _ : state) {
    std::array<float, kLanes> sums{};
    for (std::size_t i = 0; i < kNumFloats; i += kLanes)
      for (std::size_t k = 0; k < kLanes; ++k) sums[k] += values[i + k];
    benchmark::DoNotOptimize(sums);
  }
  state.SetBytesProcessed(state.iterations() * static_cast<std::int64_t>(kNumFloats * sizeof(float)));
}
BENCHMARK(MemoryRead)->Unit(benchmark::kMillisecond);

/// Multiplications and additions in registers: floating-point operations per second of one core.
void MultiplyAdd(benchmark::State& state) {
  // Ten vectors of 8: enough to hide the latency, few enough for the registers.
  constexpr std::size_t kLanes = 80;
  constexpr int kSteps = 100000;
  std::array<float, kLanes> values{};
  float factor = 0.999F;
  benchmark::DoNotOptimize(factor);
  for (auto _ : state) {
    for (int step = 0; step < kSteps; ++step)
      for (std::size_t k = 0; k < kLanes; ++k) values[k] = values[k] * factor + factor;
    benchmark::DoNotOptimize(values);
  }
  state.counters["flop_per_s"] =
      benchmark::Counter(2.0 * kSteps * kLanes, benchmark::Counter::kIsIterationInvariantRate);
}
BENCHMARK(MultiplyAdd)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace resight::bench
