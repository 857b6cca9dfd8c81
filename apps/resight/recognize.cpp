// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <cstdio>
#include <optional>

#include "camera_run.hpp"
#include "commands.hpp"
#include "line_file.hpp"
#include "live_viewer.hpp"
#include "output_paths.hpp"
#include "recognition_run.hpp"
#include "resight/core/files.hpp"
#include "resight/io/trace_file.hpp"
#include "resight/models/library_file.hpp"
#include "resight/report/html_report.hpp"
#include "resight/report/results.hpp"
#include "resight/training/training.hpp"
#include "sequence_input.hpp"

namespace resight::app {

namespace {

void print_summary(const ReportRun& run, const std::filesystem::path& out) {
  const RunSummary summary = summarize(run);
  print("{} views, {} detections, {} changes, {:.2f} s per view (median)\n", summary.num_views, summary.num_detections,
        summary.num_events, summary.median_view_wall_s);
  if (summary.num_scored_views > 0)
    print("precision {}, recall {} (5 cm, 30 deg), {} ghosts\n", format_share(summary.score.precision()),
          format_share(summary.score.recall()), summary.num_ghosts);
  print("report: {}\n", (out / "report.html").string());
}

/// The trace of a run before must not be taken for one of this run.
void forget_trace(const std::filesystem::path& out) {
  std::error_code ignored;
  std::filesystem::remove(out / kTraceFile, ignored);
}

}  // namespace

void run_recognize(const RecognizeArguments& arguments) {
  check_output_folder(arguments.out, {arguments.sequence, arguments.models}, kResultFiles);
  RecognizerConfig config =
      make_config(arguments.preset, arguments.config, arguments.num_previous_views, arguments.num_threads);
  if (arguments.seed) config.set_seed(*arguments.seed);
  if (arguments.deadline_ms) config.run.deadline_ms = *arguments.deadline_ms;
  const ModelLibrary library = value_or_throw(load_library(arguments.models, TrainOptions{}.hash()));
  if (library.objects.empty()) throw InputError(fmt::format("{}: contains no models", arguments.models.string()));
  for (const ObjectModel& object : library.objects)
    if (object.sift.size() + object.shot.size() == 0)
      print_warning(fmt::format("{}: model '{}' has no features and will not be recognised", arguments.models.string(),
                                object.name));
  const bool estimated = arguments.poses == "auto" || arguments.poses == "refine";
  OpenSequenceOptions input = arguments.input;
  if (!estimated && arguments.poses != "given") input.poses = arguments.poses;
  const auto recorded = estimated ? open_input(arguments.sequence, input) : open_posed_input(arguments.sequence, input);
  warn_about_faults(*recorded, arguments.poses != "auto");
  auto folder = value_or_throw(PendingDirectory::create(arguments.out, ExistingFolder::kFill));
  std::optional<PosedSequence> tracked;
  if (estimated) {
    TrackSequenceOptions options;
    options.refine = arguments.poses == "refine";
    options.library = &library;
    options.num_threads = arguments.num_threads;
    tracked.emplace(take_largest_component(*recorded, track_sequence(*recorded, options).track));
  }
  const Sequence& sequence = tracked ? *tracked : *recorded;
  std::optional<LiveViewer> viewer;
  if (arguments.view) viewer.emplace(sequence, library, folder_name(arguments.sequence), config.preset);
  // For a run that is interrupted or fails; the complete results take its place.
  LineFile finished(arguments.out / "finished_views.jsonl");
  LineFile trace(folder.path() / kTraceFile);
  RunObserver observer;
  observer.on_view = [&](const ViewRecord& view) {
    if (viewer) viewer->add_view(view);
    const std::string line = format_view_line(view, library);
    finished.add(line);
    if (!arguments.stream) return;
    print_text(line + "\n");
    std::fflush(stdout);  // The reader of a pipe gets each view at once.
  };
  if (arguments.trace) observer.on_trace = [&](const std::string& line) { trace.add(line); };
  ReportRun run = run_recognition(library, sequence, config, arguments.num_threads, observer);
  run.sequence = arguments.sequence.string();
  run.sequence_path = path_from(arguments.out, arguments.sequence);
  run.models_path = path_from(arguments.out, arguments.models);
  value_or_throw(write_results(folder.path(), run, library));
  value_or_throw(write_report(folder.path() / "report.html", "resight: " + folder_name(arguments.sequence),
                              std::span(&run, 1), library));
  if (!arguments.trace) forget_trace(arguments.out);
  value_or_throw(folder.commit());
  finished.remove();
  if (!arguments.stream) print_summary(run, arguments.out);
  if (!viewer) return;
  std::optional<TraceFile> shown;
  if (arguments.trace)
    shown = value_or_throw(TraceFile::open(arguments.out / kTraceFile, static_cast<int>(run.views.size())));
  viewer->finish(run, std::move(shown));
}

}  // namespace resight::app
