// SPDX-License-Identifier: Apache-2.0
// Time per view and stage over a sequence, from image files to detections: median and 95 % quantile of wall time, mean
// CPU time, number of items per stage, and peak memory. Several runs of a sequence differ in time only.
//   resight simulate --preset demo --seed 3 --out scene; resight train scene/models --out models.resight
//   bench_view_times scene models.resight [preset] [config.toml|-] [K] [threads] [max views] [objects]
// If more objects are requested than the library has, they are repeated under other names.
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <map>
#include <string>
#include <vector>

#include "../quality/arguments.hpp"
#include "resight/core/allocator.hpp"
#include "resight/io/sequence.hpp"
#include "resight/io/settings_file.hpp"
#include "resight/models/library_file.hpp"
#include "resight/recognition/scene_recognizer.hpp"
#include "resize_library.hpp"

namespace {

using namespace resight;

struct Samples {
  std::vector<double> wall_s;
  double cpu_s = 0;
};

double quantile(std::vector<double> values, double share) {
  std::sort(values.begin(), values.end());
  return values[static_cast<std::size_t>(share * static_cast<double>(values.size() - 1))];
}

void print_row(const std::string& stage, const Samples& samples) {
  fmt::print("| {} | {:.1f} | {:.1f} | {:.1f} |\n", stage, 1e3 * quantile(samples.wall_s, 0.5),
             1e3 * quantile(samples.wall_s, 0.95), 1e3 * samples.cpu_s / static_cast<double>(samples.wall_s.size()));
}

class ViewTimes {
 public:
  void add(double read_s, double whole_s, const SceneUpdate& update) {
    add_stage("read", read_s, read_s);
    double cpu_s = read_s;
    for (const StageTime& t : update.times.stages()) {
      add_stage(t.stage, t.wall_s, t.cpu_s);
      cpu_s += t.cpu_s;
    }
    whole_.wall_s.push_back(whole_s);
    whole_.cpu_s += cpu_s;
    counts_.correspondences += update.counts.correspondences;
    counts_.generated += update.counts.generated;
    counts_.merged += update.counts.merged;
    counts_.clustered += update.counts.clustered;
    counts_.accepted += update.counts.accepted;
  }

  void print() const {
    fmt::print("| stage | median, ms | 95 %, ms | CPU mean, ms |\n|---|---|---|---|\n");
    for (const std::string& stage : order_) print_row(stage, stages_.at(stage));
    print_row("**view**", whole_);
    const auto n = static_cast<double>(whole_.wall_s.size());
    fmt::print(
        "\n{:.0f} views; per view: {:.0f} correspondences, {:.0f} hypotheses, {:.0f} merged, {:.0f} clustered, {:.1f} "
        "accepted; peak memory {:.0f} MB\n",
        n, counts_.correspondences / n, counts_.generated / n, counts_.merged / n, counts_.clustered / n,
        counts_.accepted / n, 1e-6 * static_cast<double>(peak_memory_bytes()));
  }

 private:
  void add_stage(const std::string& stage, double wall_s, double cpu_s) {
    if (!stages_.contains(stage)) order_.push_back(stage);
    stages_[stage].wall_s.push_back(wall_s);
    stages_[stage].cpu_s += cpu_s;
  }
  std::vector<std::string> order_;
  std::map<std::string, Samples> stages_;
  Samples whole_;
  HypothesisCounts counts_;
};

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

}  // namespace

int main(int argc, char** argv) {
  keep_freed_memory();  // As in the program.
  if (argc < 3)
    exit_with("usage: bench_view_times SEQUENCE LIBRARY [preset] [config.toml|-] [K] [threads] [max views] [objects]");
  const auto sequence = value_or_exit(open_sequence(argv[1]));
  const auto start_loading = std::chrono::steady_clock::now();
  ModelLibrary library = value_or_exit(load_library(argv[2]));
  const double loading_s = seconds_since(start_loading);
  if (library.objects.empty()) exit_with("the library has no objects");
  if (argc > 8) resize_library(library, static_cast<std::size_t>(std::max(1, std::atoi(argv[8]))));
  RecognizerConfig config = preset_or_exit(argc > 3 ? argv[3] : "default");
  if (argc > 4 && std::string(argv[4]) != "-") config = value_or_exit(read_settings(argv[4], config));
  if (argc > 5) config.num_previous_views = std::atoi(argv[5]);
  config.set_num_threads(argc > 6 ? std::atoi(argv[6]) : 2);
  const int num_views =
      std::min(sequence->num_views(), argc > 7 ? std::max(1, std::atoi(argv[7])) : sequence->num_views());

  const auto start_building = std::chrono::steady_clock::now();
  SceneRecognizer recognizer(library, config);
  const double building_s = seconds_since(start_building);
  std::size_t num_sift = 0, num_shot = 0;
  for (const ObjectModel& object : library.objects) num_sift += object.sift.size(), num_shot += object.shot.size();
  fmt::print("{} objects, {} SIFT, {} SHOT: loaded in {:.2f} s, prepared in {:.2f} s\n\n", library.objects.size(),
             num_sift, num_shot, loading_s, building_s);

  ViewTimes times;
  for (int v = 0; v < num_views; ++v) {
    const auto start = std::chrono::steady_clock::now();
    RgbdFrame frame = value_or_exit(sequence->read_view(v));
    const double read_s = seconds_since(start);
    const SceneUpdate update = recognizer.add_view(std::move(frame));
    times.add(read_s, seconds_since(start), update);
  }
  times.print();
  return 0;
}
