// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace resight {

/// Counts of hits and mistakes, summed over views and sequences before any ratio is taken (micro average, as the
/// paper's Table I).
struct RecognitionScore {
  int true_positives = 0;   ///< Ground truth found.
  int false_positives = 0;  ///< Detections without ground truth.
  int false_negatives = 0;  ///< Ground truth missed.

  /// TP / (TP + FP); NaN where nothing was detected: no detection is neither precise nor imprecise.
  [[nodiscard]] double precision() const;
  /// TP / (TP + FN); NaN where there was nothing to find.
  [[nodiscard]] double recall() const;
  /// 2 TP / (2 TP + FP + FN), which is 2PR / (P + R) and stays defined where one of them is not; NaN if all counts are
  /// 0.
  [[nodiscard]] double f_score() const;

  RecognitionScore& operator+=(const RecognitionScore& other);
  friend bool operator==(const RecognitionScore&, const RecognitionScore&) = default;
};

}  // namespace resight
