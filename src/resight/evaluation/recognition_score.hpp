// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace resight {

/// Counts of hits and errors, summed over views and sequences before ratios are taken (micro average, as in the paper's
/// Table I).
struct RecognitionScore {
  int true_positives = 0;   ///< Ground truth that was found.
  int false_positives = 0;  ///< Detections without ground truth.
  int false_negatives = 0;  ///< Ground truth that was missed.

  /// TP / (TP + FP); NaN without detections.
  [[nodiscard]] double precision() const;
  /// TP / (TP + FN); NaN without ground truth.
  [[nodiscard]] double recall() const;
  /// 2 TP / (2 TP + FP + FN), which equals 2PR / (P + R) and remains defined if one of them is not; NaN if all counts
  /// are 0.
  [[nodiscard]] double f_score() const;

  RecognitionScore& operator+=(const RecognitionScore& other);
  friend bool operator==(const RecognitionScore&, const RecognitionScore&) = default;
};

}  // namespace resight
