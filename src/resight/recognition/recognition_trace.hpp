// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <algorithm>
#include <cstdint>
#include <vector>

#include "resight/features/feature_set.hpp"
#include "resight/hypotheses/hypothesis.hpp"
#include "resight/verification/hypothesis_evidence.hpp"

namespace resight {

/// Intermediate results of the stages at one view, to find out where an object was lost (evaluation/loss.hpp). Filled
/// on request by SceneRecognizer::add_view(); the result is the same with and without it.
struct RecognitionTrace {
  FeatureSet sift;                                           ///< Of the view, camera frame.
  FeatureSet shot;                                           ///< Of the view, camera frame.
  std::vector<std::vector<Correspondence>> correspondences;  ///< Of the view, per object; scene side in camera frame.
  std::vector<Hypothesis> merged;                            ///< Of the window, before clustering; world frame.
  std::vector<Hypothesis> clustered;                         ///< After clustering; world frame.
  std::vector<Hypothesis> verified;          ///< Without those that changes exclude or that were late; world frame.
  std::vector<HypothesisEvidence> evidence;  ///< One per entry of `verified`.
  /// That of a detection by its hypothesis_id, which must be one of the view.
  [[nodiscard]] const HypothesisEvidence& evidence_of(std::uint64_t hypothesis_id) const {
    const auto found = std::ranges::find(verified, hypothesis_id, &Hypothesis::id);
    return evidence.at(static_cast<std::size_t>(found - verified.begin()));
  }
};

}  // namespace resight
