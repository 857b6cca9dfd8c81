// SPDX-License-Identifier: Apache-2.0
#include "recognition_run.hpp"

#include <fmt/format.h>

#include <span>
#include <utility>

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

}  // namespace

ReportRun run_recognition(const ModelLibrary& library, const Sequence& sequence, const RecognizerConfig& config,
                          int num_threads, const RunObserver& observer) {
  const SequenceTruth truth = value_or_throw(read_sequence_truth(sequence, library));
  warn_about_names(truth, "ground truth");
  ReportRun run = start_run(config, num_threads);
  SceneRecognizer recognizer(library, config);
  RecognitionTrace trace;
  const bool is_traced = static_cast<bool>(observer.on_trace);
  if (is_traced) observer.on_trace(format_trace_header(run.preset, run.version));
  Progress progress(config.preset, sequence.num_views());
  const auto on_view = [&](const RgbdFrame& frame, SceneUpdate& update) {
    const int v = update.view;
    report_update(update, progress);
    std::optional<ViewEvaluation> evaluation;
    if (!truth.views.empty())
      evaluation = evaluate_view(update, truth.views[static_cast<std::size_t>(v)].objects, truth.former_places,
                                 frame.camera, library);
    if (is_traced) {
      const TracedView traced{.update = &update,
                              .trace = &trace,
                              .missed = evaluation ? std::span<const GroundTruthObject>(evaluation->missed)
                                                   : std::span<const GroundTruthObject>(),
                              .acceptance = &config.verify.acceptance};
      observer.on_trace(format_trace_line(traced, library));
    }
    run.views.push_back(make_view_record(frame, library, std::move(update), std::move(evaluation)));
    run.views.back().scene_id = sequence.scene_id();
    run.views.back().image_id = sequence.image_id(v);
    if (observer.on_view) observer.on_view(run.views.back());
  };
  auto events = recognize_sequence(recognizer, sequence, on_view, is_traced ? &trace : nullptr);
  finish_run(value_or_throw(std::move(events)), run);
  return run;
}

ReportRun run_live(const ModelLibrary& library, const NextLiveView& next, const RecognizerConfig& config,
                   int num_threads, const std::function<void(std::span<ViewRecord>)>& on_view) {
  ReportRun run = start_run(config, num_threads);
  SceneRecognizer recognizer(library, config);
  Progress progress(config.preset, 0);
  FollowedView current;
  const auto next_frame = [&]() -> Result<std::optional<RgbdFrame>> {
    std::optional<FollowedView> view = next();
    if (!view) return std::optional<RgbdFrame>();
    current = {.frame = {}, .scene_id = view->scene_id, .image_id = view->image_id};
    return std::optional(std::move(view->frame));
  };
  auto events = recognize_views(recognizer, next_frame, [&](const RgbdFrame& frame, SceneUpdate& update) {
    report_update(update, progress);
    run.views.push_back(make_view_record(frame, library, std::move(update)));
    run.views.back().scene_id = current.scene_id;
    run.views.back().image_id = current.image_id;
    if (on_view) on_view(run.views);
  });
  finish_run(value_or_throw(std::move(events)), run);
  return run;
}

}  // namespace resight::app
