// SPDX-License-Identifier: Apache-2.0
// Cost of a library before the first view, by the number of its objects: file size, time to load it and to prepare
// matching (medians of three), and memory in use afterwards. The objects of the given library are repeated under other
// names.
//   bench_library_times models.resight [objects..]     (20 50 100)
#include <fmt/format.h>
#include <malloc.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <vector>

#include "../quality/arguments.hpp"
#include "memory_in_use.hpp"
#include "resight/models/library_file.hpp"
#include "resight/recognition/view_hypothesis_generator.hpp"
#include "resize_library.hpp"

namespace {

using namespace resight;

template <typename Work>
double median_of_three_s(Work&& work) {
  std::array<double, 3> times{};
  for (double& time : times) {
    const auto start = std::chrono::steady_clock::now();
    work();
    time = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  }
  std::ranges::sort(times);
  return times[1];
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2) exit_with("usage: bench_library_times LIBRARY [objects..]");
  std::vector<int> counts;
  for (int i = 2; i < argc; ++i) {
    counts.push_back(std::atoi(argv[i]));
    if (counts.back() < 1) exit_with(fmt::format("'{}' is no number of objects", argv[i]));
  }
  if (counts.empty()) counts = {20, 50, 100};
  const auto file = std::filesystem::temp_directory_path() / fmt::format("bench_library_{}.resight", getpid());
  fmt::print("| objects | file, MB | loaded in, s | prepared in, s | memory, MB |\n|---|---|---|---|---|\n");
  for (const int count : counts) {
    {
      ModelLibrary repeated = value_or_exit(load_library(argv[1]));
      if (repeated.objects.empty()) exit_with("the library has no objects");
      resize_library(repeated, static_cast<std::size_t>(count));
      const auto saved = save_library(repeated, file);
      if (!saved.ok()) exit_with(saved.error().message);
    }
    malloc_trim(0);  // Only later allocations are measured.
    ModelLibrary library;
    const double load_s = median_of_three_s([&] {
      library = {};
      library = value_or_exit(load_library(file));
    });
    const RecognizerConfig config = preset_or_exit("default");
    double memory_mb = 0;
    const double ready_s = median_of_three_s([&] {
      const ViewHypothesisGenerator generator(library, config);
      memory_mb = memory_in_use_mb();
    });
    fmt::print("| {} | {:.0f} | {:.2f} | {:.2f} | {:.0f} |\n", count,
               1e-6 * static_cast<double>(std::filesystem::file_size(file)), load_s, ready_s, memory_mb);
    std::fflush(stdout);
  }
  std::filesystem::remove(file);
  return 0;
}
