// SPDX-License-Identifier: Apache-2.0
#include "resight/core/parallel.hpp"

#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <map>
#include <mutex>
#include <thread>

#include "resight/core/check.hpp"

#if defined(RESIGHT_THREAD_SANITIZER)
#include <sanitizer/tsan_interface.h>
#endif

namespace resight {

namespace {

// oneTBB is not instrumented, so ThreadSanitizer does not see that blocks start after the call and end before its
// return. Two tokens: blocks stay unordered among each other. The second one is passed by destructors, because a block
// may also end with an exception, which the caller then reads.
#if defined(RESIGHT_THREAD_SANITIZER)
void mark_before(char& token) { __tsan_release(&token); }
void mark_after(char& token) { __tsan_acquire(&token); }
#else
void mark_before(char& /*token*/) {}
void mark_after(char& /*token*/) {}
#endif

template <void (*mark)(char&)>
struct MarkOnExit {
  char& token;
  explicit MarkOnExit(char& marked) : token(marked) {}
  MarkOnExit(const MarkOnExit&) = delete;
  MarkOnExit& operator=(const MarkOnExit&) = delete;
  ~MarkOnExit() { mark(token); }
};

// One arena per number of threads, kept until the program ends: oneTBB 2021.8 leaks about a kilobyte per destroyed
// arena, and a view needs hundreds of calls.
tbb::task_arena& arena_of(int num_workers) {
  static std::mutex mutex;
  static auto& arenas = *new std::map<int, tbb::task_arena>();  // Never destroyed, because TBB may be unloaded earlier.
  const std::lock_guard lock(mutex);
  return arenas.try_emplace(num_workers, num_workers).first->second;
}

}  // namespace

void parallel_for_blocks(std::size_t count, std::size_t grain, int num_threads,
                         const std::function<void(std::size_t, std::size_t)>& body) {
  require(grain > 0, "parallel_for_blocks: grain = 0 (must be > 0)");
  check_positive("num_threads", num_threads);
  const std::size_t num_blocks = count / grain + (count % grain != 0 ? 1 : 0);  // does not overflow for a huge grain
  const auto run_block = [&](std::size_t block) {
    const std::size_t begin = block * grain;
    body(begin, begin + std::min(grain, count - begin));
  };
  // More threads than the hardware has gain nothing, and make TBB print a warning.
  const int num_workers = std::min(num_threads, num_hardware_threads());
  if (num_workers == 1 || num_blocks <= 1) {
    for (std::size_t block = 0; block < num_blocks; ++block) run_block(block);
    return;
  }
  char start = 0;
  char end = 0;
  mark_before(start);
  const MarkOnExit<mark_after> call(end);
  arena_of(num_workers).execute([&] {
    const auto run_marked = [&](std::size_t block) {
      mark_after(start);
      const MarkOnExit<mark_before> marked_block(end);
      run_block(block);
    };
    tbb::parallel_for(std::size_t{0}, num_blocks, run_marked, tbb::simple_partitioner());
  });
}

int num_hardware_threads() {
  static const int num_threads = std::max(1, static_cast<int>(std::thread::hardware_concurrency()));  // reads files
  return num_threads;
}

}  // namespace resight
