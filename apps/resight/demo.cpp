// SPDX-License-Identifier: Apache-2.0
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

}  // namespace

// Uses the same files and commands as a user. The folder appears when it is complete.
void run_demo(const DemoArguments& arguments) {
  auto folder = value_or_throw(PendingDirectory::create(arguments.out));
  const std::filesystem::path data = folder.path() / "data";
  const std::filesystem::path models = folder.path() / "models.resight";
  run_simulate({.preset = "demo",
                .script = {},
                .object = {},
                .out = data,
                .shown_out = arguments.out / "data",
                .format = "bop",
                .seed = arguments.seed,
                .num_threads = arguments.num_threads});
  run_train({.inputs = {data / "models"},
             .metres_per_unit = {},
             .out = models,
             .shown_out = arguments.out / "models.resight",
             .num_threads = arguments.num_threads});

  const ModelLibrary library = value_or_throw(load_library(models, TrainOptions{}.hash()));
  const auto sequence = value_or_throw(open_posed_sequence(data));
  const ChangeFiles changes{.events = data / "events.json", .changes = {}};
  std::vector<ReportRun> runs;
  for (const char* preset : {"mvr", "mvr-chd", "default"}) {
    RecognizerConfig config = make_config(preset, std::nullopt, std::nullopt, arguments.num_threads);
    config.set_seed(arguments.seed);
    runs.push_back(run_recognition(library, *sequence, changes, config, arguments.num_threads));
    runs.back().sequence = (arguments.out / "data").string();
    runs.back().sequence_path = path_from(folder.path() / preset, data);
    runs.back().models_path = path_from(folder.path() / preset, models);
    value_or_throw(write_results(folder.path() / preset, runs.back(), library));
  }
  value_or_throw(write_report(folder.path() / "report.html", "resight demo", runs, library));
  value_or_throw(folder.commit());
  print_table(runs);
  print("report: {}\n", std::filesystem::absolute(arguments.out / "report.html").string());
}

}  // namespace resight::app
