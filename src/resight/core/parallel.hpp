// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <functional>

namespace resight {

/// Calls body(begin, end) for consecutive blocks of [0, count) on up to `num_threads` threads (>= 1; 1 = serial),
/// limited to the number of hardware threads.
///
/// Block i is [i * grain, min((i + 1) * grain, count)) for every number of threads. A body that writes only the slots
/// of its own items therefore gives the same bytes on any number of threads. Reduce over blocks in order afterwards. An
/// exception of the body is rethrown here.
void parallel_for_blocks(std::size_t count, std::size_t grain, int num_threads,
                         const std::function<void(std::size_t, std::size_t)>& body);

/// Calls body(i) for each i in [0, count), with a grain of one. For few, expensive items.
template <typename Body>
void parallel_for(std::size_t count, int num_threads, Body&& body) {
  parallel_for_blocks(count, 1, num_threads, [&body](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) body(i);
  });
}

/// Calls both functions, concurrently if num_threads > 1. Either may use the functions above.
template <typename First, typename Second>
void run_both(int num_threads, First&& first, Second&& second) {
  parallel_for(2, num_threads, [&](std::size_t i) {
    if (i == 0)
      first();
    else
      second();
  });
}

/// Number of hardware threads, at least 1.
[[nodiscard]] int num_hardware_threads();

}  // namespace resight
