// SPDX-License-Identifier: Apache-2.0
#include "resight/evaluation/score_view.hpp"

#include <algorithm>

#include "resight/evaluation/match_view.hpp"

namespace resight {
namespace {

bool contains(std::span<const int> sorted, int value) { return std::ranges::binary_search(sorted, value); }

// Index into view.truth of each ground-truth object; -1 = not in the library.
std::vector<int> add_truth(const TruthView& truth, const MatchDetectionsResult& matching, const ModelLibrary& library,
                           EvaluatedView& view) {
  std::vector<int> slots(truth.objects.size(), -1);
  for (std::size_t t = 0; t < truth.objects.size(); ++t) {
    const GroundTruthObject& object = truth.objects[t];
    const int model = library.find(object.object);
    if (model < 0) continue;
    slots[t] = static_cast<int>(view.truth.size());
    EvaluatedTruth entry;
    entry.object = object.object;
    entry.instance = object.instance;
    entry.visible_share = object.visible_share;
    entry.distance_m =
        (object.camera_from_object * library.objects[static_cast<std::size_t>(model)].center.cast<double>().eval())
            .norm();
    entry.counts = !contains(matching.ignored_truth, static_cast<int>(t));
    view.truth.push_back(std::move(entry));
  }
  return slots;
}

}  // namespace

EvaluatedView score_view(int view_number, const TruthView& truth, std::span<const DetectedObject> detections,
                         std::span<const FormerPlace> former_places, const Camera& camera, const ModelLibrary& library,
                         const MatchDetectionsOptions& options) {
  const MatchedView matched = match_view(view_number, truth, detections, former_places, camera, library, options);
  EvaluatedView view;
  view.score = matched.loose.score;
  view.strict_score = matched.strict.score;
  const std::vector<int> slots = add_truth(truth, matched.loose, library, view);
  for (const DetectedObject& d : detections) view.detections.push_back({d.object, d.camera_from_object, d.score});
  const auto truth_of = [&](const DetectionMatch& match) -> EvaluatedTruth& {
    return view.truth[static_cast<std::size_t>(slots[static_cast<std::size_t>(match.truth)])];
  };
  for (const DetectionMatch& match : matched.loose.matches) {
    view.detections[static_cast<std::size_t>(match.detection)].verdict = DetectionVerdict::kCorrect;
    EvaluatedTruth& found = truth_of(match);
    found.found = true;
    found.center_error_m = match.difference.center_distance_m;
    found.rotation_error_rad = match.difference.rotation_rad;
  }
  for (const DetectionMatch& match : matched.strict.matches) truth_of(match).found_strictly = true;
  for (const int d : matched.loose.ignored_detections)
    view.detections[static_cast<std::size_t>(d)].verdict = DetectionVerdict::kIgnored;
  for (const Ghost& ghost : matched.ghosts)
    view.detections[static_cast<std::size_t>(ghost.detection)].verdict = DetectionVerdict::kGhost;
  view.num_detected_former_places =
      count_detected_former_places(former_places, truth.world_from_camera, view_number, detections, library, options);
  return view;
}

}  // namespace resight
