// SPDX-License-Identifier: Apache-2.0
#include "resight/verification/acceptance.hpp"

#include <algorithm>
#include <cmath>

#include "resight/appearance/appearance_match.hpp"
#include "resight/verification/selection_cost.hpp"

namespace resight {
namespace {

// 1 for a hypothesis that shares no texture with the scene, 0 from max_shared_contrast on.
double untextured_degree(const HypothesisEvidence& evidence, const UntexturedOptions& untextured) {
  return std::clamp(1 - evidence.appearance.shared_texture / untextured.max_shared_contrast, 0.0, 1.0);
}

double min_explained_share(const HypothesisEvidence& evidence, const AcceptanceOptions& options) {
  if (!options.untextured) return options.min_explained_share;
  return std::lerp(options.min_explained_share,
                   std::max(options.min_explained_share, options.untextured->min_explained_share),
                   untextured_degree(evidence, *options.untextured));
}

bool has_different_appearance(const HypothesisEvidence& evidence, const AcceptanceOptions& options) {
  if (evidence.appearance.texture_contrast >= kMinTextureContrast &&
      evidence.appearance.shared_texture < options.min_shared_texture * evidence.appearance.texture_contrast)
    return true;
  return (options.min_pattern_similarity && evidence.appearance.pattern_similarity < *options.min_pattern_similarity) ||
         (options.min_newest_similarity && evidence.appearance.newest_similarity < *options.min_newest_similarity);
}

}  // namespace

Verdict assess_evidence(const HypothesisEvidence& evidence, const AcceptanceOptions& options) {
  if (evidence.num_visible < kMinVisiblePoints || evidence.visible_share < options.min_visible_share)
    return Verdict::kTooFewVisible;
  if (evidence.num_explained == 0 || evidence.explained_share < min_explained_share(evidence, options))
    return Verdict::kNoSupport;
  return has_different_appearance(evidence, options) ? Verdict::kDifferentAppearance : Verdict::kCost;
}

bool has_unary_gain(const HypothesisEvidence& evidence, const AcceptanceOptions& options) {
  if (evidence.verdict != Verdict::kCost) return false;
  if (!options.require_unary_gain) return true;
  const double min_gain =
      options.untextured ? untextured_degree(evidence, *options.untextured) * options.untextured->min_gain : 0;
  return unary_cost(evidence) < -(min_gain * evidence.costs.explained_scene);
}

}  // namespace resight
