// SPDX-License-Identifier: Apache-2.0
#include "resight/verification/hypothesis_score.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "resight/verification/selection_cost.hpp"

namespace resight {
namespace {

// 1: costs nothing.
double gain_of(const HypothesisEvidence& evidence) {
  if (evidence.costs.explained_scene <= 0) return 0;
  return std::clamp(-unary_cost(evidence) / evidence.costs.explained_scene, -1.0, 1.0);
}

double share_beside_planes(const HypothesisCosts& costs) {
  const double claimed = costs.explained_scene + costs.plane;
  return claimed > 0 ? costs.explained_scene / claimed : 0;
}

}  // namespace

// Colours that are not compared are no evidence: neither that they agree nor that they differ.
ScoreCues score_cues(const HypothesisEvidence& evidence) {
  const AppearanceEvidence& appearance = evidence.appearance;
  const double is_compared = appearance.is_compared ? 1 : 0;
  return {gain_of(evidence),
          std::log1p(evidence.num_correspondences),
          evidence.fit,
          std::log(0.01 + evidence.visible_share),
          is_compared * std::log1p(appearance.shared_texture),
          share_beside_planes(evidence.costs),
          is_compared * appearance.newest_similarity,
          -evidence.seen_through_share,
          -is_compared * std::log(0.02 + appearance.silhouette_error),
          is_compared * appearance.hue_similarity,
          1 - is_compared};
}

double hypothesis_score(const HypothesisEvidence& evidence, const HypothesisScoreOptions& options) {
  const ScoreCues weights = {options.gain_weight,    options.correspondence_weight, options.fit_weight,
                             options.visible_weight, options.texture_weight,        options.beside_planes_weight,
                             options.newest_weight,  options.seen_through_weight,   options.silhouette_weight,
                             options.hue_weight,     options.uncolored_weight};
  const ScoreCues cues = score_cues(evidence);
  return 1 / (1 + std::exp(-std::inner_product(cues.begin(), cues.end(), weights.begin(), options.offset)));
}

}  // namespace resight
