// SPDX-License-Identifier: Apache-2.0
#include "resight/evaluation/evaluate_sequence.hpp"

#include <algorithm>
#include <optional>
#include <utility>

#include "resight/core/check.hpp"
#include "resight/evaluation/loss.hpp"
#include "resight/evaluation/match_view.hpp"
#include "resight/evaluation/score_view.hpp"
#include "resight/recognition/recognize_sequence.hpp"

namespace resight {
namespace {

class SequenceEvaluator {
 public:
  SequenceEvaluator(const SequenceTruth& truth, const ModelLibrary& library, const RecognizerConfig& config,
                    const EvaluateSequenceOptions& options)
      : truth_(truth),
        library_(library),
        options_(options),
        has_changes_(config.changes.enabled && truth.changes.has_value()) {
    run_.preset = config.preset;
    run_.num_previous_views = config.num_previous_views;
    run_.is_clustered = config.hypotheses.cluster.has_value();
    run_.num_former_places = static_cast<int>(std::ranges::count_if(truth.former_places, &FormerPlace::is_proven));
    run_.num_published_places = static_cast<int>(truth.former_places.size());
    run_.has_changes = has_changes_;
    if (!has_changes_) return;
    points_.emplace(library, truth, config.num_previous_views);
    visibilities_.emplace(library, truth, options.match);
  }

  void add_view(const RgbdFrame& frame, const SceneUpdate& update, const RecognitionTrace& trace) {
    const int number = update.view;
    const TruthView& truth = truth_.views[static_cast<std::size_t>(number)];
    EvaluatedView view = score_view(number, truth, to_detected_objects(update, library_), truth_.former_places,
                                    frame.camera, library_, options_.match);
    view.name = frame.name;
    view.counts = update.counts;
    view.times = update.times;
    if (options_.find_losses) find_losses(truth, update.world_from_camera, trace, view);
    if (points_) view.points = points_->add_view(frame, update.changes.removed_in_world, update.changes.novel_in_world);
    if (visibilities_) visibilities_->add_view(frame);
    run_.views.push_back(std::move(view));
    if (options_.progress) options_.progress(number, run_.views.back());
  }

  EvaluatedRun finish(const std::vector<std::vector<ObjectEvent>>& events) {
    if (visibilities_)
      run_.events = score_events(*truth_.changes, visibilities_->visibilities(), reported_changes(events), library_,
                                 options_.match);
    return std::move(run_);
  }

 private:
  // The hypotheses live in the world of the corrected camera poses.
  void find_losses(const TruthView& truth, const Rigid3& world_from_camera, const RecognitionTrace& trace,
                   EvaluatedView& view) const {
    std::size_t entry = 0;  // Index into view.truth, which skips objects that are not in the library.
    FindLossOptions loss_options;
    loss_options.match = options_.match;
    for (const GroundTruthObject& object : truth.objects) {
      if (library_.find(object.object) < 0) continue;
      EvaluatedTruth& t = view.truth[entry++];
      if (t.counts && !t.found)
        t.lost_at = to_string(find_loss(object, world_from_camera, trace, library_, loss_options).stage);
    }
  }

  [[nodiscard]] std::vector<ReportedChange> reported_changes(
      const std::vector<std::vector<ObjectEvent>>& events) const {
    std::vector<ReportedChange> changes;
    for (std::size_t v = 0; v < events.size(); ++v)
      for (const ObjectEvent& e : events[v])
        if (is_change(e.kind))
          changes.push_back({.view = e.view,
                             .kind = e.kind,
                             .object = library_.objects[static_cast<std::size_t>(e.object)].name,
                             .world_from_object_before = e.world_from_object_before,
                             .world_from_object_after = e.world_from_object_after,
                             .reported_view = static_cast<int>(v)});
    return changes;
  }

  const SequenceTruth& truth_;
  const ModelLibrary& library_;
  const EvaluateSequenceOptions& options_;
  bool has_changes_;
  std::optional<ChangePointScorer> points_;
  std::optional<ChangeVisibilityFinder> visibilities_;
  EvaluatedRun run_;
};

}  // namespace

Result<EvaluatedRun> evaluate_sequence(const Sequence& sequence, const SequenceTruth& truth,
                                       const ModelLibrary& library, const RecognizerConfig& config,
                                       const EvaluateSequenceOptions& options) {
  require(static_cast<int>(truth.views.size()) == sequence.num_views(),
          "evaluate_sequence: the truth must have as many views as the sequence");
  SequenceEvaluator evaluator(truth, library, config, options);
  SceneRecognizer recognizer(library, config, options.hypotheses);
  RecognitionTrace trace;
  const auto events = recognize_sequence(
      recognizer, sequence,
      [&](const RgbdFrame& frame, const SceneUpdate& update) { evaluator.add_view(frame, update, trace); },
      options.find_losses ? &trace : nullptr);
  if (!events) return events.error();
  return evaluator.finish(*events);
}

}  // namespace resight
