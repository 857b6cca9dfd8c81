// SPDX-License-Identifier: Apache-2.0
#include "resight/verification/acceptance.hpp"

#include <algorithm>
#include <cmath>

#include "resight/verification/selection_cost.hpp"

namespace resight {
namespace {

constexpr double kTextureContrast = 1;

// 1 for what shares no contrast with the scene, 0 from max_shared_contrast on.
double plainness(const HypothesisEvidence& evidence, const UntexturedOptions& plain) {
  if (plain.max_shared_contrast <= 0) return 0;
  return std::clamp(1 - evidence.shared_texture / plain.max_shared_contrast, 0.0, 1.0);
}

}  // namespace

Verdict judge_evidence(const HypothesisEvidence& evidence, const VerifyOptions& options) {
  const double plain = plainness(evidence, options.plain);
  const double min_explained = std::lerp(
      options.min_explained_share, std::max(options.min_explained_share, options.plain.min_explained_share), plain);
  if (evidence.num_visible < options.min_visible_points || evidence.visible_share < options.min_visible_share)
    return Verdict::kTooFewVisible;
  if (evidence.num_explained == 0 || evidence.explained_share < min_explained) return Verdict::kNoSupport;
  const bool lacks_texture = evidence.texture_contrast >= kTextureContrast &&
                             evidence.shared_texture < options.min_shared_print * evidence.texture_contrast;
  const bool is_other = lacks_texture || evidence.pattern_similarity < options.min_pattern_similarity ||
                        evidence.newest_similarity < options.min_newest_similarity;
  return is_other ? Verdict::kDifferentAppearance : Verdict::kCost;
}

bool has_unary_gain(const HypothesisEvidence& evidence, const VerifyOptions& options) {
  if (evidence.verdict != Verdict::kCost) return false;
  if (!options.must_pay_alone) return true;
  const double min_gain = plainness(evidence, options.plain) * options.plain.min_gain * evidence.explained_scene;
  return unary_cost(evidence, options) < -min_gain;
}

}  // namespace resight
