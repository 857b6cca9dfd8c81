// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <set>

#include "commands.hpp"
#include "output_paths.hpp"
#include "recognition_run.hpp"
#include "resight/core/files.hpp"
#include "resight/io/sequence.hpp"
#include "resight/models/library_file.hpp"
#include "resight/report/html_report.hpp"
#include "resight/report/results.hpp"
#include "resight/training/training.hpp"

namespace resight::app {
namespace {

constexpr const char* kUnfinished = ".resight-demo-unfinished";

void print_table(const std::vector<ReportRun>& runs) {
  print("\n{:<10} {:>9} {:>7} {:>7} {:>7} {:>8} {:>10}\n", "preset", "precision", "recall", "F", "ghosts", "changes",
        "s/view");
  for (const ReportRun& run : runs) {
    const RunSummary s = summarize(run);
    print("{:<10} {:>9} {:>7} {:>7} {:>7} {:>8} {:>10.2f}\n", run.preset, format_share(s.score.precision()),
          format_share(s.score.recall()), format_share(s.score.f_score()), s.num_ghosts, s.num_events,
          s.median_view_wall_s);
  }
  print("(right: within 5 cm and 30 deg; ghost: an object reported at a place it has left)\n\n");
}

/// Removes what an interrupted demo has left in the folder, so that it can start again.
void clear_unfinished(const std::filesystem::path& out) {
  if (!std::filesystem::exists(out / kUnfinished)) return;
  const std::set<std::string> ours{"data", "models.resight", "mvr", "mvr-chd", "default", "report.html", kUnfinished};
  std::vector<std::filesystem::path> left;
  for (const auto& entry : std::filesystem::directory_iterator(out))
    if (ours.contains(entry.path().filename().string()) || entry.path().extension() == ".resight-partial")
      left.push_back(entry.path());
  for (const std::filesystem::path& path : left) std::filesystem::remove_all(path);
}

}  // namespace

// Uses the same files and commands as a user.
void run_demo(const DemoArguments& arguments) {
  clear_unfinished(arguments.out);
  check_new_folder(arguments.out);
  value_or_throw(write_file(arguments.out / kUnfinished, "removed by 'resight demo' when it is finished\n"));
  const std::filesystem::path data = arguments.out / "data";
  const std::filesystem::path models = arguments.out / "models.resight";
  run_simulate({.preset = "demo",
                .script = {},
                .object = {},
                .out = data,
                .format = "bop",
                .seed = arguments.seed,
                .num_threads = arguments.num_threads});
  run_train({.inputs = {data / "models"}, .metres_per_unit = {}, .out = models, .num_threads = arguments.num_threads});

  const ModelLibrary library = value_or_throw(load_library(models, TrainOptions{}.hash()));
  const auto sequence = value_or_throw(open_posed_sequence(data));
  std::vector<ReportRun> runs;
  for (const char* preset : {"mvr", "mvr-chd", "default"}) {
    RecognizerConfig config = make_config(preset, std::nullopt, std::nullopt, arguments.num_threads);
    config.set_seed(arguments.seed);
    runs.push_back(run_recognition(library, *sequence, config, arguments.num_threads));
    runs.back().sequence = data.string();
    runs.back().sequence_path = path_from(arguments.out / preset, data);
    runs.back().models_path = path_from(arguments.out / preset, models);
    value_or_throw(write_results(arguments.out / preset, runs.back(), library));
  }
  const std::filesystem::path report = arguments.out / "report.html";
  value_or_throw(write_report(report, "resight demo", runs, library));
  std::filesystem::remove(arguments.out / kUnfinished);
  print_table(runs);
  print("report: {}\n", std::filesystem::absolute(report).string());
}

}  // namespace resight::app
