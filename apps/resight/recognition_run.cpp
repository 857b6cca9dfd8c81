// SPDX-License-Identifier: Apache-2.0
#include "recognition_run.hpp"

#include <fmt/format.h>

#include <optional>
#include <utility>

#include "commands.hpp"
#include "progress.hpp"
#include "resight/core/timing.hpp"
#include "resight/evaluation/change_truth.hpp"
#include "resight/io/settings_file.hpp"
#include "resight/recognition/recognize_sequence.hpp"
#include "resight/report/trace_lines.hpp"

namespace resight::app {
namespace {

std::string describe(const SceneUpdate& update) {
  std::string text = fmt::format("{}: {} objects", update.view_name, update.detections.size());
  for (const ObjectEvent& event : update.events)
    if (is_change(event.kind)) text += fmt::format(", {}", to_string(event.kind));
  return text + fmt::format(", {:.2f} s", update.times.total_wall_s());
}

}  // namespace

RecognizerConfig make_config(const std::string& preset, const std::optional<std::filesystem::path>& file,
                             std::optional<int> num_previous_views, int num_threads) {
  RecognizerConfig config = RecognizerConfig::from_preset(preset);
  if (file) config = value_or_throw(read_settings(*file, config));
  if (num_previous_views) config.num_previous_views = *num_previous_views;
  config.set_num_threads(num_threads);
  return config;
}

void warn_about_names(const SequenceTruth& truth, const std::string& sequence) {
  if (truth.names == TruthNames::kFoundById)
    print_warning(
        fmt::format("{}: the library has other names for the true objects; they were found by obj_id", sequence));
  if (truth.names == TruthNames::kNotInLibrary)
    print_warning(fmt::format("{}: no true object is in the library, so that nothing can be right", sequence));
}

namespace {

ReportRun start_run(const RecognizerConfig& config, int num_threads) {
  ReportRun run;
  run.preset = config.preset;
  run.version = RESIGHT_VERSION;
  run.num_threads = num_threads;
  run.settings = config.to_settings();
  return run;
}

void report_update(const SceneUpdate& update, Progress& progress) {
  progress.report(update.view + 1, describe(update));
  if (!update.left_out.empty())
    print_warning(
        fmt::format("{}: skipped to meet the deadline: {}", update.view_name, fmt::join(update.left_out, ", ")));
}

void finish_run(std::vector<std::vector<ObjectEvent>> final_events, ReportRun& run) {
  for (std::size_t v = 0; v < run.views.size(); ++v) run.views[v].update.events = std::move(final_events[v]);
  run.peak_memory_bytes = peak_memory_bytes();
}

/// Records the views of a run, and tells the observer of each.
class RunRecorder {
 public:
  RunRecorder(const ModelLibrary& library, const RecognizerConfig& config, const RunObserver& observer, ReportRun& run)
      : library_(&library), acceptance_(&config.verify.acceptance), observer_(&observer), run_(&run) {
    if (observer.on_trace) observer.on_trace(format_trace_header(run.preset, run.version));
  }
  /// To be filled with each view before it is added; null: nothing is traced.
  [[nodiscard]] RecognitionTrace* trace() { return observer_->on_trace ? &trace_ : nullptr; }

  void add(const RgbdFrame& frame, SceneUpdate& update, std::optional<ViewEvaluation> evaluation, int scene_id,
           int image_id) {
    if (observer_->on_trace) {
      TracedView traced{.update = &update, .trace = &trace_, .missed = {}, .acceptance = acceptance_};
      if (evaluation) traced.missed = evaluation->missed;
      observer_->on_trace(format_trace_line(traced, *library_));
    }
    ViewRecord& view =
        run_->views.emplace_back(make_view_record(frame, *library_, std::move(update), std::move(evaluation)));
    view.scene_id = scene_id;
    view.image_id = image_id;
    if (observer_->on_view) observer_->on_view(run_->views);
  }

 private:
  const ModelLibrary* library_;
  const AcceptanceOptions* acceptance_;
  const RunObserver* observer_;
  ReportRun* run_;
  RecognitionTrace trace_;
};

}  // namespace

ReportRun run_recognition(const ModelLibrary& library, const Sequence& sequence, const ChangeFiles& changes,
                          const RecognizerConfig& config, int num_threads, const RunObserver& observer) {
  const SequenceTruth truth = value_or_throw(read_sequence_truth(sequence, library, changes));
  warn_about_names(truth, "ground truth");
  ReportRun run = start_run(config, num_threads);
  SceneRecognizer recognizer(library, config);
  RunRecorder recorder(library, config, observer, run);
  Progress progress(config.preset, sequence.num_views());
  const auto on_view = [&](const RgbdFrame& frame, SceneUpdate& update) {
    const int v = update.view;
    report_update(update, progress);
    std::optional<ViewEvaluation> evaluation;
    if (!truth.views.empty())
      evaluation =
          evaluate_view(update, truth.views[static_cast<std::size_t>(v)], truth.former_places, frame.camera, library);
    recorder.add(frame, update, std::move(evaluation), sequence.scene_id(), sequence.image_id(v));
  };
  finish_run(value_or_throw(recognize_sequence(recognizer, sequence, on_view, recorder.trace())), run);
  return run;
}

ReportRun run_live(const ModelLibrary& library, const NextLiveView& next, const RecognizerConfig& config,
                   int num_threads, const RunObserver& observer) {
  ReportRun run = start_run(config, num_threads);
  SceneRecognizer recognizer(library, config);
  RunRecorder recorder(library, config, observer, run);
  Progress progress(config.preset, 0);
  FollowedView current;
  const auto next_frame = [&]() -> Result<std::optional<RgbdFrame>> {
    std::optional<FollowedView> view = next();
    if (!view) return std::optional<RgbdFrame>();
    current = {.frame = {}, .scene_id = view->scene_id, .image_id = view->image_id};
    return std::optional(std::move(view->frame));
  };
  const auto on_view = [&](const RgbdFrame& frame, SceneUpdate& update) {
    report_update(update, progress);
    recorder.add(frame, update, std::nullopt, current.scene_id, current.image_id);
  };
  finish_run(value_or_throw(recognize_views(recognizer, next_frame, on_view, recorder.trace())), run);
  return run;
}

}  // namespace resight::app
