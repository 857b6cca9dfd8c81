// SPDX-License-Identifier: Apache-2.0
// Two configurations on paired seeds: mean difference over all sequences of all seeds, with its standard error. Each
// pair of folders contains the results of `resight evaluate` for one seed with configurations A and B.
//   for s in 11 12 13; do
//     resight simulate --preset dynamic-tabletop --seed $s --format bop --out s$s
//     resight evaluate --models m.resight --dataset s$s --presets default --out a$s
//     resight evaluate --models m.resight --dataset s$s --presets default --config b.toml --out b$s
//   done
//   bench_compare_results a11 b11 a12 b12 a13 b13
// `resight evaluate --shard I/N` divides each of them for a job array.
#include <fmt/format.h>

#include <algorithm>
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

// Runs by preset; `seed` separates the sequences of different seeds, `side` separates A from B.
void add_runs(const fs::path& folder, int seed, const char* side,
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
    run.sequence = fmt::format("{}/{}", seed, run.sequence);
    std::vector<EvaluatedRun>& runs = all[run.preset];
    run.preset = side;
    runs.push_back(std::move(run));
  }
}

std::string show(const PairedDifference& d) { return fmt::format("{:+.4f} +- {:.4f}", d.mean, d.standard_error); }

}  // namespace

int main(int argc, char** argv) {
  if (argc < 3 || argc % 2 == 0) exit_with("usage: bench_compare_results A B [A B ...]");
  std::map<std::string, std::vector<EvaluatedRun>> runs_of_preset;
  for (int i = 1; i + 1 < argc; i += 2) {
    add_runs(argv[i], i / 2, "A", runs_of_preset);
    add_runs(argv[i + 1], i / 2, "B", runs_of_preset);
  }
  fmt::print("| preset | K | sequences | precision | recall | F | strict F | ghosts per former place |\n");
  fmt::print("|---|---|---|---|---|---|---|---|\n");
  for (const auto& [preset, runs] : runs_of_preset)
    for (const PresetComparison& c : compare_presets(runs))
      fmt::print("| {} | {} | {} | {} | {} | {} | {} | {} |\n", preset, c.num_previous_views, c.precision.num_pairs,
                 show(c.precision), show(c.recall), show(c.f_score), show(c.strict_f_score), show(c.ghosts_per_change));
  return 0;
}
