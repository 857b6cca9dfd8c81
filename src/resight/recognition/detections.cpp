// SPDX-License-Identifier: Apache-2.0
#include "resight/recognition/detections.hpp"

#include "resight/recognition/competing_poses.hpp"
#include "resight/recognition/instance_prior.hpp"
#include "resight/verification/appearance_check.hpp"

namespace resight {
namespace {

std::vector<DetectionViewEvidence> evidence_of_views(const VerifiedHypotheses& verified, std::size_t hypothesis,
                                                     const std::deque<DynamicScene::View>& window) {
  const HypothesisEvidence& evidence = verified.evidence[hypothesis];
  const std::size_t num_hypotheses = verified.hypotheses.size();
  std::vector<DetectionViewEvidence> views;
  for (std::size_t v = 0; v < window.size(); ++v)
    views.push_back({window[v].number,
                     verified.present.empty() || verified.present[v * num_hypotheses + hypothesis] != 0,
                     evidence.visible_share_per_view[v], evidence.explained_share_per_view[v], 0});
  return views;
}

// The colours count unless the view sees through as much of the object.
void confirm_by_colors(Detection& detection, const RgbdFrame& current, const ModelLibrary& library,
                       const RecognizerConfig& config) {
  DetectionViewEvidence& newest = detection.views.back();
  if (newest.confirmed_share() >= config.detections.min_reported_share) return;
  const double share = color_confirmed_share(library.objects[static_cast<std::size_t>(detection.object)],
                                             detection.world_from_object, current, config.verify);
  if (share > newest.visible_share) newest.color_share = share;
}

}  // namespace

std::vector<Detection> make_detections(const VerifiedHypotheses& verified, const std::deque<DynamicScene::View>& window,
                                       const ModelLibrary& library, const RecognizerConfig& config) {
  std::vector<Detection> detections;
  std::vector<double> pose_scores;
  for (std::size_t h = 0; h < verified.hypotheses.size(); ++h) {
    const Hypothesis& hypothesis = verified.hypotheses[h];
    const HypothesisEvidence& evidence = verified.evidence[h];
    if (!evidence.accepted) continue;
    Detection& detection = detections.emplace_back();
    detection.object = hypothesis.object;
    detection.hypothesis_id = hypothesis.id;
    detection.world_from_object = evidence.world_from_object;
    detection.uncertainty = evidence.uncertainty;
    const PlaceScore score =
        config.detections.weigh_competing_poses ? score_place(verified, h, library) : PlaceScore{evidence.score, 1};
    detection.score = score.place;
    pose_scores.push_back(score.pose);
    detection.fit = evidence.fit;
    detection.visible_share = evidence.visible_share;
    detection.views = evidence_of_views(verified, h, window);
    confirm_by_colors(detection, window.back().raw, library, config);
  }
  apply_instance_prior(detections, config.detections.further_instance_odds);
  for (std::size_t i = 0; i < detections.size(); ++i) detections[i].score *= pose_scores[i];
  return detections;
}

void drop_unlikely(std::vector<Detection>& detections, const DetectionOptions& options) {
  std::erase_if(detections, [&](const Detection& d) {
    return d.views.back().confirmed_share() < options.min_reported_share || d.score < options.min_score;
  });
}

}  // namespace resight
