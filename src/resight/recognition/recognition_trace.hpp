// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <vector>

#include "resight/features/feature_set.hpp"
#include "resight/hypotheses/hypothesis.hpp"
#include "resight/verification/verify_options.hpp"

namespace resight {

/// What the stages handed on at one view: for finding out where an object was lost (evaluation/loss.hpp). Filled on
/// request by SceneRecognizer::add_view(); it changes nothing of the result.
struct RecognitionTrace {
  FeatureSet sift;                                           ///< Of the view, camera frame.
  FeatureSet shot;                                           ///< Of the view, camera frame.
  std::vector<std::vector<Correspondence>> correspondences;  ///< Of the view, per object; scene side in camera frame.
  std::vector<Hypothesis> merged;                            ///< Of the window, before clustering; world frame.
  std::vector<Hypothesis> clustered;                         ///< After clustering; world frame.
  std::vector<Hypothesis> verified;          ///< Of these, those that the changes do not exclude; world frame.
  std::vector<HypothesisEvidence> evidence;  ///< One per entry of `verified`.
};

}  // namespace resight
