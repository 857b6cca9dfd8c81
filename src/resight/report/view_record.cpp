// SPDX-License-Identifier: Apache-2.0
#include "resight/report/view_record.hpp"

#include <algorithm>
#include <limits>
#include <utility>

#include "resight/core/check.hpp"
#include "resight/evaluation/match_view.hpp"

namespace resight {
namespace {

std::vector<DetectionMark> marks_of(const ViewEvaluation& evaluation, std::size_t num_detections) {
  std::vector<DetectionMark> marks(num_detections, DetectionMark::kUnjudged);
  const auto set = [&marks](int detection, DetectionMark mark) {
    require(detection >= 0 && static_cast<std::size_t>(detection) < marks.size(),
            "make_view_record: the evaluation does not match the detections");
    marks[static_cast<std::size_t>(detection)] = mark;
  };
  for (const DetectionMatch& match : evaluation.matching.matches) set(match.detection, DetectionMark::kCorrect);
  for (const int detection : evaluation.matching.false_positives) set(detection, DetectionMark::kFalsePositive);
  for (const int detection : evaluation.matching.ignored_detections) set(detection, DetectionMark::kIgnored);
  for (const Ghost& ghost : evaluation.ghosts) set(ghost.detection, DetectionMark::kGhost);
  return marks;
}

double median(std::vector<double> values) {
  if (values.empty()) return std::numeric_limits<double>::quiet_NaN();
  std::sort(values.begin(), values.end());
  const std::size_t half = values.size() / 2;
  return values.size() % 2 == 1 ? values[half] : 0.5 * (values[half - 1] + values[half]);
}

int count_changes(std::span<const ObjectEvent> events) {
  return static_cast<int>(
      std::count_if(events.begin(), events.end(), [](const ObjectEvent& event) { return is_change(event.kind); }));
}

}  // namespace

ViewEvaluation evaluate_view(const SceneUpdate& update, const TruthView& truth,
                             std::span<const FormerPlace> former_places, const Camera& camera,
                             const ModelLibrary& library, const MatchDetectionsOptions& options) {
  MatchedView matched =
      match_view(update.view, truth, to_detected_objects(update, library), former_places, camera, library, options);
  ViewEvaluation evaluation;
  for (const int missed : matched.loose.false_negatives)
    evaluation.missed.push_back(truth.objects[static_cast<std::size_t>(missed)]);
  evaluation.matching = std::move(matched.loose);
  evaluation.strict_score = matched.strict.score;
  evaluation.ghosts = std::move(matched.ghosts);
  return evaluation;
}

void MakeViewRecordOptions::check() const {
  check_in_range("MakeViewRecordOptions.picture_quality", picture_quality, 1, 100);
  check_not_negative("MakeViewRecordOptions.max_picture_width_px", max_picture_width_px);
  overlay.check();
}

ViewRecord make_view_record(const RgbdFrame& frame, const ModelLibrary& library, SceneUpdate update,
                            std::optional<ViewEvaluation> evaluation, const MakeViewRecordOptions& options) {
  options.check();
  ViewRecord record;
  record.image_id = update.view;
  record.num_novel_points = update.changes.novel_in_world.size();
  record.num_removed_points = update.changes.removed_in_world.size();
  record.marks = evaluation ? marks_of(*evaluation, update.detections.size())
                            : std::vector<DetectionMark>(update.detections.size(), DetectionMark::kUnjudged);
  if (options.picture) {
    const std::span<const GroundTruthObject> missed =
        evaluation ? std::span<const GroundTruthObject>(evaluation->missed) : std::span<const GroundTruthObject>();
    const Image<Rgb8> picture = draw_overlay(frame, library, update, record.marks, missed, options.overlay);
    record.picture_jpeg = encode_jpeg(picture, options.picture_quality, options.max_picture_width_px);
  }
  update.changes.novel_in_world = {};
  update.changes.removed_in_world = {};
  update.changes.novel_mask = {};
  update.changes.removed_mask = {};
  record.update = std::move(update);
  record.evaluation = std::move(evaluation);
  return record;
}

RunSummary summarize(const ReportRun& run) {
  RunSummary summary;
  std::vector<double> view_wall_s;
  double total_wall_s = 0;
  for (const ViewRecord& view : run.views) {
    ++summary.num_views;
    summary.num_detections += static_cast<int>(view.update.detections.size());
    summary.num_events += count_changes(view.update.events);
    summary.times.add(view.update.times);
    view_wall_s.push_back(view.update.times.total_wall_s());
    total_wall_s += view_wall_s.back();
    if (!view.evaluation) continue;
    ++summary.num_scored_views;
    summary.score += view.evaluation->matching.score;
    summary.strict_score += view.evaluation->strict_score;
    summary.num_ghosts += static_cast<int>(view.evaluation->ghosts.size());
  }
  summary.mean_view_wall_s =
      summary.num_views == 0 ? std::numeric_limits<double>::quiet_NaN() : total_wall_s / summary.num_views;
  summary.median_view_wall_s = median(view_wall_s);
  return summary;
}

}  // namespace resight
