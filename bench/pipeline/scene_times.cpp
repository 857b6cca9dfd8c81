// SPDX-License-Identifier: Apache-2.0
// Time of Algorithm 1 alone (poses, changes, reconstruction), view by view, and a checksum of all results.
// Optimisations of the stage must not change the checksum. Needs no models.
//   bench_scene_times sequence [preset] [K] [threads] [passes]
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <vector>

#include "../quality/arguments.hpp"
#include "resight/core/allocator.hpp"
#include "resight/core/hash.hpp"
#include "resight/core/timing.hpp"
#include "resight/io/sequence.hpp"
#include "resight/recognition/stage_options.hpp"
#include "resight/reconstruction/dynamic_scene.hpp"

namespace {

using namespace resight;

template <typename T>
std::uint64_t checksum_of(const std::vector<T>& values, std::uint64_t seed) {
  return checksum_bytes({reinterpret_cast<const std::uint8_t*>(values.data()), values.size() * sizeof(T)}, seed);
}

std::uint64_t checksum_of(const PointCloud& cloud, std::uint64_t sum) {
  return checksum_of(cloud.colors, checksum_of(cloud.normals, checksum_of(cloud.points, sum)));
}

/// All NaN values count as equal.
std::uint64_t checksum_of(const Image<float>& image, std::uint64_t sum) {
  std::vector<float> values(image.data().begin(), image.data().end());
  for (float& value : values) value = std::isnan(value) ? -1.0F : value;
  return checksum_of(values, sum);
}

std::uint64_t checksum_of(const DynamicScene& scene, const ChangeResult& changes, std::uint64_t sum) {
  sum = checksum_of(scene.reconstruction(), sum);
  sum = checksum_of(changes.removed_in_world, checksum_of(changes.novel_in_world, sum));
  for (const DynamicScene::View& view : scene.window())
    sum = checksum_of(view.cleared.edge_distance_px, checksum_of(view.cleared.frame.depth_m, sum));
  sum = checksum_bytes(changes.novel_mask.data(), sum);
  for (const int count : changes.evidence_count) sum = checksum_of(std::vector<int>{count}, sum);
  return sum;
}

std::vector<PreparedView> prepare_all(const std::string& folder, const PrepareViewOptions& options) {
  const auto sequence = value_or_exit(open_sequence(folder));
  std::vector<PreparedView> views;
  for (int v = 0; v < sequence->num_views(); ++v)
    views.push_back(prepare_view(value_or_exit(sequence->read_view(v)), options));
  return views;
}

}  // namespace

int main(int argc, char** argv) {
  keep_freed_memory();  // As in the program.
  if (argc < 2) exit_with("usage: bench_scene_times SEQUENCE [preset] [K] [threads] [passes]");
  RecognizerConfig config = preset_or_exit(argc > 2 ? argv[2] : "default");
  if (argc > 3) config.num_previous_views = std::atoi(argv[3]);
  config.set_num_threads(argc > 4 ? std::atoi(argv[4]) : 2);
  const int num_passes = argc > 5 ? std::max(1, std::atoi(argv[5])) : 1;
  const std::vector<PreparedView> views = prepare_all(argv[1], config.prepare);

  std::vector<double> wall_s;
  double cpu_s = 0;
  std::uint64_t sum = kHashSeed;
  for (int pass = 0; pass < num_passes; ++pass) {
    DynamicScene scene(scene_options(config));
    sum = kHashSeed;
    for (const PreparedView& view : views) {
      PreparedView copy = view;
      StageTimes times;
      ChangeResult changes;
      {
        const ScopedTimer timer(times, "scene");
        changes = scene.add_view(std::move(copy));
      }
      wall_s.push_back(times.stages().front().wall_s);
      cpu_s += times.stages().front().cpu_s;
      sum = checksum_of(scene, changes, sum);
      if (pass == 0)
        fmt::print("| {} | {:.1f} ms | {} points | {} removed | {} novel | {} {} {} {} |\n",
                   scene.window().back().number, 1e3 * wall_s.back(), scene.reconstruction().size(),
                   changes.removed_in_world.size(), changes.novel_in_world.size(), changes.evidence_count[0],
                   changes.evidence_count[1], changes.evidence_count[2], changes.evidence_count[3]);
    }
  }
  std::sort(wall_s.begin(), wall_s.end());
  fmt::print("{} views: median {:.1f} ms, 95 % {:.1f} ms, CPU mean {:.1f} ms; checksum {:016x}\n", wall_s.size(),
             1e3 * wall_s[wall_s.size() / 2], 1e3 * wall_s[wall_s.size() * 95 / 100],
             1e3 * cpu_s / static_cast<double>(wall_s.size()), sum);
  return 0;
}
