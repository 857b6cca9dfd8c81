// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "resight/verification/verify_options.hpp"

namespace resight {

/// Weights of a logistic regression; all 0: 0.5 for any evidence. The weights of the presets (recognizer_config.cpp)
/// were fitted to their detections at K = 5 on two seeds of `dynamic-tabletop`; docs/results.md says how well they
/// generalise. Those of `default` leave out the similarity of colours, which depends on the lighting.
struct DetectionScoreOptions {
  double offset = 0;
  double gain_weight = 0;            ///< Of what it explains of the scene less what it costs, as a share of the former.
  double correspondence_weight = 0;  ///< Of log(1 + correspondences).
  double fit_weight = 0;             ///< Of how well it explains its visible points (HypothesisEvidence::fit).
  double visible_weight = 0;         ///< Of the visible share of the model's points.
  double known_weight = 0;           ///< Of its having been recognised there before: 1 or 0.
  void check() const;                ///< Throws std::invalid_argument: field, value, rule.
};

/// How likely an accepted hypothesis is right, in [0, 1]: of the detections with score s about a share s is.
[[nodiscard]] double detection_score(const HypothesisEvidence& evidence, bool is_tracked,
                                     const DetectionScoreOptions& options);

}  // namespace resight
