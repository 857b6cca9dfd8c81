// SPDX-License-Identifier: Apache-2.0
#include "resight/core/parallel.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <atomic>
#include <limits>
#include <mutex>
#include <stdexcept>
#include <utility>
#include <vector>

#include "resight/core/timing.hpp"

namespace resight {
namespace {

using Blocks = std::vector<std::pair<std::size_t, std::size_t>>;

Blocks collect_blocks(std::size_t count, std::size_t grain, int num_threads) {
  Blocks blocks;
  std::mutex mutex;
  parallel_for_blocks(count, grain, num_threads, [&](std::size_t begin, std::size_t end) {
    const std::lock_guard lock(mutex);
    blocks.emplace_back(begin, end);
  });
  std::ranges::sort(blocks);
  return blocks;
}

TEST(ParallelForBlocks, BlocksAreTheSameForAnyNumberOfThreads) {
  for (const std::size_t count : {0U, 1U, 9U, 10U, 11U, 1000U, 1003U})
    for (const std::size_t grain : {1U, 10U, 64U, 5000U}) {
      Blocks expected;
      for (std::size_t begin = 0; begin < count; begin += grain)
        expected.emplace_back(begin, std::min(begin + grain, count));
      for (const int threads : {1, 2, 3, 8})
        EXPECT_EQ(collect_blocks(count, grain, threads), expected) << count << '/' << grain;
    }
}

TEST(ParallelForBlocks, AHugeGrainIsOneBlock) {
  for (const int threads : {1, 2})
    EXPECT_EQ(collect_blocks(5, std::numeric_limits<std::size_t>::max(), threads), (Blocks{{0, 5}}));
}

TEST(ParallelForBlocks, RethrowsAnExceptionOfTheBody) {
  for (const int threads : {1, 2, 4}) {
    const auto run = [&] {
      parallel_for_blocks(1000, 10, threads, [](std::size_t begin, std::size_t) {
        if (begin == 500) throw std::runtime_error("block 500");
      });
    };
    EXPECT_THAT(run, testing::ThrowsMessage<std::runtime_error>("block 500")) << threads;
  }
}

TEST(ParallelForBlocks, SerialRunsInOrder) {
  std::vector<std::size_t> begins;
  parallel_for_blocks(100, 7, 1, [&](std::size_t begin, std::size_t) { begins.push_back(begin); });
  EXPECT_EQ(begins.size(), 15U);
  EXPECT_TRUE(std::ranges::is_sorted(begins));
}

TEST(ParallelForBlocks, RefusesNonsense) {
  const auto nothing = [](std::size_t, std::size_t) {};
  EXPECT_THROW(parallel_for_blocks(10, 0, 1, nothing), std::invalid_argument);
  EXPECT_THROW(parallel_for_blocks(10, 1, 0, nothing), std::invalid_argument);
  EXPECT_THROW(parallel_for_blocks(10, 1, -2, nothing), std::invalid_argument);
}

TEST(ParallelFor, VisitsEachItemOnce) {
  for (const int threads : {1, 2, 5}) {
    std::vector<std::atomic<int>> visits(1000);
    parallel_for(visits.size(), threads, [&](std::size_t i) { ++visits[i]; });
    EXPECT_TRUE(std::ranges::all_of(visits, [](const auto& n) { return n == 1; }));
  }
}

TEST(ParallelFor, MayBeNested) {
  std::atomic<int> sum = 0;
  parallel_for(
      8, 2, [&](std::size_t i) { parallel_for(100, 2, [&](std::size_t j) { sum += static_cast<int>(i * 100 + j); }); });
  EXPECT_EQ(sum, 799 * 800 / 2);
}

TEST(ParallelFor, LeavesNoMemoryBehind) {
  std::atomic<int> sum = 0;
  const auto run = [&](int times) {
    for (int i = 0; i < times; ++i) parallel_for(4, 2, [&](std::size_t) { ++sum; });
    return peak_memory_bytes();
  };
  const std::size_t before = run(1000);
  EXPECT_LT(run(20000), before + (std::size_t{4} << 20U))
      << "memory must not grow with the number of calls: a view needs hundreds, a day of views 100 million";
  EXPECT_EQ(sum, 84000);
}

TEST(NumHardwareThreads, IsAtLeastOne) { EXPECT_GE(num_hardware_threads(), 1); }

}  // namespace
}  // namespace resight
