// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "resight/core/options.hpp"
#include "resight/verification/verify_options.hpp"

namespace resight {

/// Weights of a logistic regression; all 0: 0.5 for any evidence. The weights of the presets (presets.cpp)
/// were fitted to their detections at K = 5 on two seeds of `dynamic-tabletop`; docs/results.md says how well they
/// generalise. Those of `default` leave out the similarity of colours, which depends on the lighting.
struct DetectionScoreOptions {
  double offset = 0;
  double gain_weight = 0;
  double correspondence_weight = 0;
  double fit_weight = 0;
  double visible_weight = 0;
  double tracked_weight = 0;
  void check() const { check_options("DetectionScoreOptions", *this); }
};

inline void declare(OptionVisitor& v, DetectionScoreOptions& o) {
  v.field("offset", o.offset, between(-100, 100), "Log odds of being right before any evidence.", "fitted");
  v.field("gain_weight", o.gain_weight, between(0, 100),
          "Of the unary gain: what it explains of the scene less what it costs, as a share of the former.", "fitted");
  v.field("correspondence_weight", o.correspondence_weight, between(0, 100), "Of log(1 + correspondences).", "fitted");
  v.field("fit_weight", o.fit_weight, between(0, 100), "Of how well its visible points are explained.", "fitted");
  v.field("visible_weight", o.visible_weight, between(0, 100), "Of the visible share of the model.", "fitted");
  v.field("tracked_weight", o.tracked_weight, between(0, 100), "Of having been recognised there before.", "fitted");
}

/// How likely an accepted hypothesis is right, in [0, 1]: of the detections with score s about a share s is.
[[nodiscard]] double detection_score(const HypothesisEvidence& evidence, bool is_tracked,
                                     const DetectionScoreOptions& options);

}  // namespace resight
