// SPDX-License-Identifier: Apache-2.0
#include "resight/report/worst_views.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>

#include "resight/report/internal/markdown.hpp"
#include "resight/report/overlay.hpp"

namespace resight {
namespace {

using report::escape_markdown;

std::vector<WorstView> bad_views(std::span<const EvaluatedRun* const> runs) {
  std::vector<WorstView> bad;
  for (const EvaluatedRun* run : runs)
    for (std::size_t v = 0; v < run->views.size(); ++v) {
      const RecognitionScore& score = run->views[v].score;
      if (score.false_negatives + score.false_positives > 0)
        bad.push_back({run, static_cast<int>(v), 0, score.false_negatives, score.false_positives});
    }
  std::ranges::stable_sort(bad, std::greater{}, [](const WorstView& b) { return b.num_missed + b.num_wrong; });
  return bad;
}

std::string configuration_name(const EvaluatedRun& run) {
  return fmt::format("`{}`, K = {}{}", run.preset, run.num_previous_views,
                     run.is_clustered ? "" : ", without clustering");
}

DetectionMark mark_of(DetectionVerdict verdict) {
  switch (verdict) {
    case DetectionVerdict::kCorrect:
      return DetectionMark::kCorrect;
    case DetectionVerdict::kFalsePositive:
      return DetectionMark::kFalsePositive;
    case DetectionVerdict::kGhost:
      return DetectionMark::kGhost;
    case DetectionVerdict::kIgnored:
      return DetectionMark::kIgnored;
  }
  return DetectionMark::kUnjudged;
}

bool was_missed(const GroundTruthObject& object, const EvaluatedView& view) {
  return std::ranges::any_of(view.truth, [&](const EvaluatedTruth& t) {
    return t.counts && !t.found && t.object == object.object && t.instance == object.instance;
  });
}

}  // namespace

std::vector<WorstView> find_worst_views(std::span<const EvaluatedRun> runs, int max_views_per_configuration) {
  std::vector<WorstView> worst;
  std::vector<const EvaluatedRun*> left;
  for (const EvaluatedRun& run : runs) left.push_back(&run);
  while (!left.empty()) {
    const EvaluatedRun& first = *left.front();
    const auto rest = std::stable_partition(left.begin(), left.end(), [&](const EvaluatedRun* run) {
      return run->preset == first.preset && run->num_previous_views == first.num_previous_views &&
             run->is_clustered == first.is_clustered;
    });
    std::vector<WorstView> bad = bad_views(std::vector<const EvaluatedRun*>(left.begin(), rest));
    left.erase(left.begin(), rest);
    bad.resize(std::min(bad.size(), static_cast<std::size_t>(std::max(0, max_views_per_configuration))));
    for (std::size_t i = 0; i < bad.size(); ++i) {
      bad[i].rank = static_cast<int>(i);
      worst.push_back(bad[i]);
    }
  }
  return worst;
}

std::string format_worst_views(std::span<const WorstView> views, int num_pictures) {
  std::string text = "# Worst views first\n";
  for (const WorstView& w : views) {
    const EvaluatedView& view = w.evaluated();
    if (w.rank == 0) text += fmt::format("\n## {}\n", configuration_name(*w.run));
    text += fmt::format("\n### {} view {}: {} missed, {} wrong\n\n", escape_markdown(w.run->sequence),
                        escape_markdown(view.name), w.num_missed, w.num_wrong);
    if (w.rank < num_pictures) text += fmt::format("![{}]({})\n\n", escape_markdown(view.name), worst_view_picture(w));
    for (const EvaluatedTruth& t : view.truth)
      if (t.counts && !t.found)
        text += fmt::format("- missed {} {} ({}at {:.2f} m): {}\n", escape_markdown(t.object), t.instance,
                            std::isnan(t.visible_share) ? "" : fmt::format("{:.0f} % visible, ", 100 * t.visible_share),
                            t.distance_m, t.lost_at.empty() ? "not traced" : t.lost_at);
    for (const EvaluatedDetection& d : view.detections)
      if (d.verdict == DetectionVerdict::kFalsePositive || d.verdict == DetectionVerdict::kGhost)
        text += fmt::format("- {} {} (score {:.2f}, at {:.2f} m)\n", to_string(d.verdict), escape_markdown(d.object),
                            d.score, d.camera_from_object.translation.norm());
  }
  return text;
}

std::string worst_view_picture(const WorstView& view) {
  return fmt::format("worst/{}{}_k{}_{}.jpg", view.run->preset, view.run->is_clustered ? "" : "_unclustered",
                     view.run->num_previous_views, view.rank + 1);
}

Image<Rgb8> draw_evaluated_view(const RgbdFrame& frame, const ModelLibrary& library,
                                std::span<const GroundTruthObject> truth, const EvaluatedView& view) {
  SceneUpdate update;
  update.world_from_camera = frame.world_from_camera;
  std::vector<DetectionMark> marks;
  for (const EvaluatedDetection& d : view.detections) {
    Detection& detection = update.detections.emplace_back();
    detection.object = library.find(d.object);
    detection.world_from_object = frame.world_from_camera * d.camera_from_object;
    detection.score = d.score;
    marks.push_back(mark_of(d.verdict));
  }
  std::vector<GroundTruthObject> missed;
  std::ranges::copy_if(truth, std::back_inserter(missed),
                       [&](const GroundTruthObject& object) { return was_missed(object, view); });
  return draw_overlay(frame, library, update, marks, missed, {.show_changes = false});
}

}  // namespace resight
