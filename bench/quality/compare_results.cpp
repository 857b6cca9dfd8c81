// SPDX-License-Identifier: Apache-2.0
// Two configurations on paired seeds: mean difference over all sequences of all seeds, with its standard error. Each
// pair of folders contains the results of `resight evaluate` for one seed with configurations A and B. Runs without a
// partner are left out and named. Use new folders: runs with other settings that are left in one count, too.
//   for s in 11 12 13; do
//     resight simulate --preset dynamic-tabletop --seed $s --format bop --out s$s
//     resight evaluate --models m.resight --dataset s$s --presets default --out a$s
//     resight evaluate --models m.resight --dataset s$s --presets default --config b.toml --out b$s
//   done
//   bench_compare_results a11 b11 a12 b12 a13 b13
// `resight evaluate --shard I/N` divides each of them for a job array.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>
#include <vector>

#include "arguments.hpp"
#include "resight/evaluation/evaluated_run.hpp"
#include "resight/evaluation/paired_difference.hpp"

namespace {

using namespace resight;
namespace fs = std::filesystem;

// Runs by preset; `pair` separates the sequences of different seeds, `side` separates A from B.
void add_runs(const fs::path& folder, int pair, const char* side,
              std::map<std::string, std::vector<EvaluatedRun>>& all) {
  std::vector<fs::path> files;
  std::error_code code;
  for (const auto& entry : fs::directory_iterator(folder / "runs", code)) files.push_back(entry.path());
  if (files.empty()) exit_with(folder.string() + ": holds no runs (expected a folder of 'resight evaluate')");
  std::ranges::sort(files);
  for (const fs::path& file : files) {
    std::ostringstream text;
    text << std::ifstream(file, std::ios::binary).rdbuf();
    EvaluatedRun run = value_or_exit(parse_run(text.str(), file.string()));
    run.sequence = fmt::format("{}/{}", pair, run.sequence);
    std::vector<EvaluatedRun>& runs = all[run.preset];
    run.preset = side;
    runs.push_back(std::move(run));
  }
}

// One line per run of one side that the other side lacks.
void name_lone_runs(const std::string& preset, const std::vector<EvaluatedRun>& runs) {
  for (const EvaluatedRun& run : runs) {
    const auto is_partner = [&](const EvaluatedRun& other) {
      return other.preset != run.preset && other.is_clustered && other.sequence == run.sequence &&
             other.num_previous_views == run.num_previous_views;
    };
    if (run.is_clustered && std::ranges::none_of(runs, is_partner))
      fmt::print(stderr, "left out: only {} has preset {}, K = {} of {} (number of the pair, sequence)\n", run.preset,
                 preset, run.num_previous_views, run.sequence);
  }
}

std::string show(const PairedDifference& d) {
  return d.num_pairs > 0 ? fmt::format("{:+.4f} ± {:.4f}", d.mean, d.standard_error) : "-";
}

// The ratio of two times from the difference of their logarithms.
std::string show_ratio(const PairedDifference& d) {
  const double ratio = std::exp(d.mean);
  return d.num_pairs > 0 ? fmt::format("{:.2f} ± {:.2f}", ratio, ratio * d.standard_error) : "-";
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 3 || argc % 2 == 0) exit_with("usage: bench_compare_results A B [A B ...]");
  std::map<std::string, std::vector<EvaluatedRun>> runs_of_preset;
  // The first side compared is A, so all of A come first.
  for (int i = 1; i < argc; i += 2) add_runs(argv[i], (i + 1) / 2, "A", runs_of_preset);
  for (int i = 2; i < argc; i += 2) add_runs(argv[i], i / 2, "B", runs_of_preset);
  for (const auto& [preset, runs] : runs_of_preset) name_lone_runs(preset, runs);
  fmt::print(
      "| preset | K | sequences | right, A and B | wrong, A and B | precision | recall | F | strict F | "
      "ghosts per former place | F of events | CPU, B / A |\n");
  fmt::print("|---|---|---|---|---|---|---|---|---|---|---|---|\n");
  bool is_empty = true;
  for (const auto& [preset, runs] : runs_of_preset)
    for (const PresetComparison& c : compare_presets(runs)) {
      is_empty = false;
      fmt::print("| {} | {} | {} | {}, {} | {}, {} |", preset, c.num_previous_views, c.num_sequences,
                 c.score_of_a.true_positives, c.score_of_b.true_positives, c.score_of_a.false_positives,
                 c.score_of_b.false_positives);
      for (const PairedDifference* d :
           {&c.precision, &c.recall, &c.f_score, &c.strict_f_score, &c.ghosts_per_change, &c.event_f_score})
        fmt::print(" {} |", show(*d));
      fmt::print(" {} |\n", show_ratio(c.log_cpu));
    }
  if (is_empty) exit_with("no run has a partner");
  return 0;
}
