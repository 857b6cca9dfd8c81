// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <span>
#include <vector>

namespace resight {

/// The detections whose scores lie in [from, from of the next bin), or up to 1.
struct ScoreBin {
  double from = 0;
  int right = 0;
  int wrong = 0;  ///< Ghosts included.
  double sum_score = 0;

  [[nodiscard]] int count() const { return right + wrong; }
  [[nodiscard]] double mean_score() const { return sum_score / count(); }  ///< NaN if empty.
  [[nodiscard]] double share_right() const { return static_cast<double>(right) / count(); }
};

/// How far scores are what they claim to be: of those with score s a share s is right. Bins are narrower towards 1,
/// where most detections lie.
class Reliability {
 public:
  Reliability();
  /// Throws std::invalid_argument for a score that is not in [0, 1].
  void add(double score, bool is_right);
  [[nodiscard]] std::span<const ScoreBin> bins() const { return bins_; }
  /// Expected calibration error: |mean score - share right|, mean over the detections (Naeini et al., AAAI 2015, there
  /// with bins of one width). NaN without detections.
  [[nodiscard]] double calibration_error() const;

 private:
  std::vector<ScoreBin> bins_;
};

}  // namespace resight
