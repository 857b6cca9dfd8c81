// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <functional>
#include <optional>
#include <span>
#include <string>

#include "resight/evaluation/change_truth.hpp"
#include "resight/io/follow_sequence.hpp"
#include "resight/models/object_model.hpp"
#include "resight/recognition/recognizer_config.hpp"
#include "resight/report/view_record.hpp"
#include "resight/sensor/sequence.hpp"

namespace resight::app {

/// Configuration from the preset, overridden by the config file, then by the command line.
[[nodiscard]] RecognizerConfig make_config(const std::string& preset, const std::optional<std::filesystem::path>& file,
                                           std::optional<int> num_previous_views, int num_threads);

/// Warns if the library does not have the names of the true objects.
void warn_about_names(const SequenceTruth& truth, const std::string& sequence);

/// Receives what happens during a run.
struct RunObserver {
  /// All views up to the newest, whenever there is a new one. Later views may change its events. Pictures may be
  /// stored.
  std::function<void(std::span<ViewRecord>)> on_view;
  /// The lines of trace.jsonl, each before its view; empty = nothing is traced.
  std::function<void(const std::string& line)> on_trace;
};

/// Recognises every view of a sequence, with progress. Scores the views if the sequence has ground truth; `changes`:
/// its true changes.
[[nodiscard]] ReportRun run_recognition(const ModelLibrary& library, const Sequence& sequence,
                                        const ChangeFiles& changes, const RecognizerConfig& config, int num_threads,
                                        const RunObserver& observer = {});

/// The next view of a camera or of a folder that is being written; none at the end.
using NextLiveView = std::function<std::optional<FollowedView>()>;

/// Same for views that come one by one. Waits in `next`.
[[nodiscard]] ReportRun run_live(const ModelLibrary& library, const NextLiveView& next, const RecognizerConfig& config,
                                 int num_threads, const RunObserver& observer);

}  // namespace resight::app
