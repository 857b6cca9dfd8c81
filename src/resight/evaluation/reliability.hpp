// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <span>
#include <vector>

namespace resight {

/// Detections with scores in [from, from of the next bin); the last bin includes 1.
struct ScoreBin {
  double from = 0;
  int right = 0;
  int wrong = 0;  ///< Includes ghosts.
  double sum_score = 0;

  [[nodiscard]] int count() const { return right + wrong; }
  [[nodiscard]] double mean_score() const { return sum_score / count(); }  ///< NaN if empty.
  [[nodiscard]] double share_right() const { return static_cast<double>(right) / count(); }
};

/// Calibration of scores: of the detections with score s, a share of s should be right. Bins are narrower towards 1,
/// where most detections are.
class Reliability {
 public:
  Reliability();
  /// Throws std::invalid_argument for a score outside [0, 1].
  void add(double score, bool is_right);
  [[nodiscard]] std::span<const ScoreBin> bins() const { return bins_; }
  /// Expected calibration error: |mean score - share right|, weighted by the number of detections per bin (Naeini et
  /// al., AAAI 2015, but with bins of different widths). NaN without detections.
  [[nodiscard]] double calibration_error() const;

 private:
  std::vector<ScoreBin> bins_;
};

}  // namespace resight
