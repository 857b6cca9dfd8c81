// SPDX-License-Identifier: Apache-2.0
// Whether memory and time per view stay constant over a long stream. A sequence is played forwards and backwards until
// the given number of views is reached; its changes are reversed each time. Prints twenty rows: memory in use, and the
// median time since the last row of the views that were searched and of the others.
//   bench_stream_memory sequence models.resight [preset] [views=10000] [threads=2]
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <vector>

#include "../quality/arguments.hpp"
#include "memory_in_use.hpp"
#include "resight/core/allocator.hpp"
#include "resight/core/statistics.hpp"
#include "resight/io/sequence.hpp"
#include "resight/models/library_file.hpp"
#include "resight/recognition/scene_recognizer.hpp"

namespace {

using namespace resight;

constexpr int kRows = 20;

// 0 1 2 1 0 1 ...
std::size_t frame_at(std::size_t view, std::size_t num_frames) {
  const std::size_t period = std::max<std::size_t>(1, 2 * (num_frames - 1));
  const std::size_t at = view % period;
  return at < num_frames ? at : period - at;
}

struct Row {
  std::vector<double> searched_ms;
  std::vector<double> quiet_ms;
  std::size_t detections = 0;
  std::size_t changes = 0;
};

}  // namespace

int main(int argc, char** argv) {
  keep_freed_memory();  // As in the program.
  if (argc < 3) exit_with("usage: bench_stream_memory SEQUENCE LIBRARY [preset] [views] [threads]");
  const auto sequence = value_or_exit(open_sequence(argv[1]));
  const ModelLibrary library = value_or_exit(load_library(argv[2]));
  RecognizerConfig config = preset_or_exit(argc > 3 ? argv[3] : "default");
  const auto num_views = static_cast<std::size_t>(std::max(kRows, argc > 4 ? std::atoi(argv[4]) : 10000));
  config.set_num_threads(argc > 5 ? std::atoi(argv[5]) : 2);
  std::vector<RgbdFrame> frames;
  for (int v = 0; v < sequence->num_views(); ++v) frames.push_back(value_or_exit(sequence->read_view(v)));
  if (frames.empty()) exit_with("the sequence has no view");

  SceneRecognizer recognizer(library, config);
  fmt::print(
      "| views | memory, MB | quiet view, ms | searched view, ms | searched | detections per view | changes |\n");
  fmt::print("|---|---|---|---|---|---|---|\n");
  Row row;
  for (std::size_t v = 0; v < num_views; ++v) {
    RgbdFrame frame = frames[frame_at(v, frames.size())];
    const auto start = std::chrono::steady_clock::now();
    const SceneUpdate update = recognizer.add_view(std::move(frame));
    const double ms = 1e3 * std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    (update.searched ? row.searched_ms : row.quiet_ms).push_back(ms);
    row.detections += update.detections.size();
    row.changes += static_cast<std::size_t>(
        std::ranges::count_if(update.events, [](const ObjectEvent& e) { return is_change(e.kind); }));
    if ((v + 1) * kRows / num_views == v * kRows / num_views) continue;
    const std::size_t count = row.searched_ms.size() + row.quiet_ms.size();
    fmt::print("| {} | {:.0f} | {:.1f} | {:.1f} | {} | {:.2f} | {} |\n", v + 1, memory_in_use_mb(),
               upper_median(row.quiet_ms), upper_median(row.searched_ms), row.searched_ms.size(),
               static_cast<double>(row.detections) / static_cast<double>(count), row.changes);
    std::fflush(stdout);
    row = {};
  }
  return 0;
}
