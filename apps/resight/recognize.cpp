// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <optional>
#include <span>
#include <string_view>

#include "camera_run.hpp"
#include "commands.hpp"
#include "follow_views.hpp"
#include "line_file.hpp"
#include "live_viewer.hpp"
#include "output_paths.hpp"
#include "recognition_run.hpp"
#include "resight/core/files.hpp"
#include "resight/io/recognition_results.hpp"
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
  if (summary.num_detections == 0)
    print("nothing was recognised; if that is wrong, 'resight check --models' may tell the reason\n");
  if (summary.num_scored_views > 0)
    print("precision {}, recall {} (5 cm, 30 deg), {} ghosts\n", format_share(summary.score.precision()),
          format_share(summary.score.recall()), summary.num_ghosts);
  if (run.num_skipped_views.value_or(0) > 0)
    print("{} views were overtaken by newer ones and skipped\n", *run.num_skipped_views);
  print("report: {}\n", (out / "report.html").string());
}

// For a run that is interrupted or fails; the complete results take its place.
constexpr const char* kFinishedViews = "finished_views.jsonl";

/// Moves the results to their place. The trace of a run before must not be taken for one of this run, but may only go
/// together with the other old results: an empty one replaces it, and is removed afterwards.
void commit_results(const RecognizeArguments& arguments, PendingDirectory& folder) {
  const std::filesystem::path trace = arguments.out / kTraceFile;
  std::error_code error;
  const bool has_old_trace = !arguments.trace && std::filesystem::exists(trace, error);
  if (has_old_trace) value_or_throw(write_file(folder.path() / kTraceFile, ""));
  value_or_throw(folder.commit());
  if (has_old_trace) std::filesystem::remove(trace, error);
}

/// Keeps a view that is finished, and prints it.
void report_view(const RecognizeArguments& arguments, const ViewRecord& view, const ModelLibrary& library,
                 LineFile& finished) {
  const std::string line = format_view_line(view, library);
  finished.add(line);
  if (!arguments.stream) return;
  print_json(line + "\n");
  std::fflush(stdout);  // The reader of a pipe gets each view at once.
}

// How the sequence was opened, for `resight view`. Files are named from the folder of the results, as the inputs are.
std::vector<std::string> describe_input(const RecognizeArguments& arguments) {
  std::vector<std::string> given = arguments.given_input;
  const auto max_views = std::ranges::find(given, "--max-views");
  if (arguments.follow.is_on && max_views != given.end()) given.erase(max_views, max_views + 2);  // Not of the folder.
  const std::string poses = with_poses({}, arguments.poses).poses;
  if (!poses.empty()) given.insert(given.end(), {"--poses", poses});
  for (std::size_t i = 1; i < given.size(); ++i) {
    std::error_code error;
    if (may_name_file(given[i - 1], given[i]) && std::filesystem::is_regular_file(given[i], error))
      given[i] = path_from(arguments.out, given[i]);
  }
  return given;
}

void write_run(const RecognizeArguments& arguments, ReportRun& run, const ModelLibrary& library,
               PendingDirectory& folder, LineFile& finished) {
  const bool has_folder = arguments.camera.empty();
  run.sequence = has_folder ? arguments.sequence.string() : arguments.camera;
  if (has_folder) run.sequence_path = path_from(arguments.out, arguments.sequence);
  if (has_folder) run.sequence_options = describe_input(arguments);
  run.models_path = path_from(arguments.out, arguments.models);
  const std::string title = "resight: " + (has_folder ? folder_name(arguments.sequence) : arguments.camera);
  value_or_throw(write_results(folder.path(), run, library));
  value_or_throw(write_report(folder.path() / "report.html", title, std::span(&run, 1), library));
  commit_results(arguments, folder);
  remove_old_pages(arguments.out, static_cast<int>(run.views.size()));
  finished.remove();
  if (!arguments.stream) print_summary(run, arguments.out);
}

/// Moves pictures to files as soon as the report has pages. `views`: all so far.
void store_new_pictures(std::span<ViewRecord> views, const std::filesystem::path& folder) {
  if (views.size() <= kViewsPerPage) return;
  const std::size_t num_stored = views.size() == kViewsPerPage + 1 ? 0 : views.size() - 1;
  for (ViewRecord& view : views.subspan(num_stored)) value_or_throw(store_picture(view, folder));
}

/// The files of a run that grow with each view.
class RunFiles {
 public:
  RunFiles(const RecognizeArguments& arguments, const ModelLibrary& library)
      : arguments_(&arguments),
        library_(&library),
        folder_(value_or_throw(PendingDirectory::create(arguments.out, ExistingFolder::kFill))),
        finished_(arguments.out / kFinishedViews),
        trace_(trace_file()) {}

  [[nodiscard]] RunObserver observer() {
    RunObserver observer;
    observer.on_view = [this](std::span<ViewRecord> views) {
      store_new_pictures(views, folder_.path());
      report_view(*arguments_, views.back(), *library_, finished_);
    };
    if (arguments_->trace) observer.on_trace = [this](const std::string& line) { trace_.add(line); };
    return observer;
  }
  /// Where the trace is before the results are complete.
  [[nodiscard]] std::filesystem::path trace_file() const { return folder_.path() / kTraceFile; }
  void complete(ReportRun& run) {
    trace_.sync();
    write_run(*arguments_, run, *library_, folder_, finished_);
  }

 private:
  const RecognizeArguments* arguments_;
  const ModelLibrary* library_;
  PendingDirectory folder_;
  LineFile finished_;
  LineFile trace_;
};

void recognize_live(LiveViews& views, const RecognizeArguments& arguments, const ModelLibrary& library,
                    const RecognizerConfig& config) {
  RunFiles files(arguments, library);
  const std::optional<int> max_views = arguments.input.views.max_views;
  int num_taken = 0;
  const auto next = [&] { return max_views && num_taken++ >= *max_views ? std::nullopt : views.next(); };
  ReportRun run = run_live(library, next, config, arguments.num_threads, files.observer());
  run.num_skipped_views = views.num_skipped();
  files.complete(run);
}

/// The true changes by which the run is scored. Their places are in the world of the given poses.
ChangeFiles find_scored_changes(const RecognizeArguments& arguments, const Sequence& sequence) {
  if (!sequence.has_ground_truth() || arguments.poses != "given") return {};
  const TrueChangeFiles found = find_true_changes(arguments.sequence, arguments.input, sequence);
  return found.sequence_lacks_views ? ChangeFiles{} : found.files;
}

void recognize_recorded(const Sequence& sequence, RunFiles& files, const RecognizeArguments& arguments,
                        const ModelLibrary& library, const RecognizerConfig& config) {
  std::optional<LiveViewer> viewer;
  RunObserver observer = files.observer();
  if (arguments.view) {
    std::optional<TraceFile> trace;
    if (arguments.trace) trace = TraceFile::follow(files.trace_file());
    viewer.emplace(sequence, library, folder_name(arguments.sequence), config.preset, std::move(trace));
    observer.on_view = [&viewer, on_view = std::move(observer.on_view)](std::span<ViewRecord> views) {
      viewer->add_view(views.back());
      on_view(views);
    };
  }
  ReportRun run = run_recognition(library, sequence, find_scored_changes(arguments, sequence), config,
                                  arguments.num_threads, observer);
  files.complete(run);
  if (!viewer) return;
  std::optional<TraceFile> trace;
  if (arguments.trace)
    trace = value_or_throw(TraceFile::open(arguments.out / kTraceFile, static_cast<int>(run.views.size())));
  viewer->finish(run, std::move(trace));
}

/// `given`: names and values in turn.
void check_camera_options(const std::vector<std::string>& given) {
  constexpr std::string_view kApply[] = {"--intrinsics", "--sensor", "--depth-bias", "--max-views"};
  for (std::size_t i = 0; i < given.size(); i += 2)
    if (std::ranges::find(kApply, given[i]) == std::end(kApply))
      throw InputError(given[i] + " does not apply to the views of --camera");
}

}  // namespace

void run_recognize(const RecognizeArguments& arguments) {
  const bool is_live = arguments.follow.is_on || !arguments.camera.empty();
  if (arguments.follow.keeps_late && !arguments.follow.is_on) throw InputError("--keep-late needs --follow");
  if (arguments.follow.idle_timeout_s && !is_live) throw InputError("--idle-timeout-s needs --follow or --camera");
  if (arguments.camera.empty() == arguments.sequence.empty()) throw InputError("give either --sequence or --camera");
  check_output_folder(arguments.out, "recognize",
                      {arguments.camera.empty() ? arguments.sequence : arguments.models, arguments.models});
  value_or_throw(check_writable_folder(arguments.out / kReportPages, ExistingFolder::kFill));
  RecognizerConfig config =
      make_config(arguments.preset, arguments.config, arguments.num_previous_views, arguments.num_threads);
  if (arguments.seed) config.set_seed(*arguments.seed);
  if (arguments.deadline_ms) config.run.deadline_ms = *arguments.deadline_ms;
  if (arguments.poses == "fixed" || !arguments.camera.empty()) config.camera.poses.fixed = true;
  const ModelLibrary library = value_or_throw(load_library(arguments.models, TrainOptions{}.hash()));
  if (library.objects.empty()) throw InputError(fmt::format("{}: contains no models", arguments.models.string()));
  for (const ObjectModel& object : library.objects)
    if (object.sift.size() + object.shot.size() == 0)
      print_warning(fmt::format("{}: model '{}' has no features and will not be recognised", arguments.models.string(),
                                object.name));
  if (!arguments.camera.empty()) {
    if (arguments.poses != "given" && arguments.poses != "fixed")
      throw InputError("the camera of --camera must not move: give --poses fixed or none");
    check_camera_options(arguments.given_input);
    CameraViews views(arguments.camera, arguments.input, arguments.follow);
    return recognize_live(views, arguments, library, config);
  }
  if (arguments.follow.is_on) {
    if (is_estimated(arguments.poses))
      throw InputError("--follow needs poses with each view: --poses given, fixed or a file");
    OpenSequenceOptions input = with_poses(arguments.input, arguments.poses);
    input.views.max_views.reset();  // Counted here: of the folder, the first views may have been skipped.
    FolderViews views(arguments.sequence, input, arguments.follow);
    return recognize_live(views, arguments, library, config);
  }
  const auto recorded = open_recorded_input(arguments.sequence, arguments.input, arguments.poses);
  RunFiles files(arguments, library);
  const auto tracked = estimate_poses(*recorded, arguments.sequence, arguments.poses, &library, arguments.num_threads);
  recognize_recorded(tracked ? static_cast<const Sequence&>(*tracked) : *recorded, files, arguments, library, config);
}

}  // namespace resight::app
