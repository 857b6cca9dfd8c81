// SPDX-License-Identifier: Apache-2.0
#include "resight/recognition/detection_score.hpp"

#include <algorithm>
#include <cmath>

namespace resight {
namespace {

// 1: costs nothing. What is accepted beside others may cost more than it explains alone.
double gain_of(const HypothesisEvidence& evidence) {
  if (evidence.costs.explained_scene <= 0) return 0;
  return std::clamp(-evidence.costs.unary / evidence.costs.explained_scene, -1.0, 1.0);
}

}  // namespace

double detection_score(const HypothesisEvidence& evidence, bool is_tracked, const DetectionScoreOptions& options) {
  const double log_odds = options.offset + options.gain_weight * gain_of(evidence) +
                          options.correspondence_weight * std::log1p(evidence.num_correspondences) +
                          options.fit_weight * evidence.fit + options.visible_weight * evidence.visible_share +
                          (is_tracked ? options.tracked_weight : 0);
  return 1 / (1 + std::exp(-log_odds));
}

}  // namespace resight
