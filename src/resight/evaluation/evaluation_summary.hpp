// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <map>
#include <span>
#include <string>
#include <vector>

#include "resight/evaluation/evaluated_run.hpp"
#include "resight/evaluation/reliability.hpp"

namespace resight {

/// Hits and misses of a kind of object (by name, or by visible share).
struct FoundCount {
  int found = 0;
  int missed = 0;
  int false_positives = 0;             ///< By name only; ghosts included.
  std::map<std::string, int> lost_at;  ///< Missed objects per stage.
};

struct ErrorQuantiles {
  int count = 0;
  double median = 0;  ///< NaN without errors.
  double p95 = 0;
};
/// By the nearest rank: the p-quantile of n values is the ceil(p n)-th smallest.
[[nodiscard]] ErrorQuantiles error_quantiles(std::vector<double> values);

/// One configuration over all sequences of an evaluation.
struct ConfigurationSummary {
  std::string preset;
  int num_previous_views = 0;  ///< K.
  bool is_clustered = true;
  int num_sequences = 0;
  int num_views = 0;
  RecognitionScore score;         ///< Within 5 cm and 30 deg.
  RecognitionScore strict_score;  ///< Within 1 cm and 10 deg.
  ErrorQuantiles center_error_m;  ///< Of the true positives within the loose pair.
  ErrorQuantiles rotation_error_rad;
  Reliability reliability;  ///< Of the scores of all detections that count.
  int num_ghosts = 0;
  int num_former_places = 0;  ///< Places left, over the sequences.
  HypothesisCounts counts;    ///< Sums over the views.
  bool has_changes = false;
  ChangePointScores points;
  EventScore events;
  std::map<std::string, FoundCount> by_object;
  std::vector<FoundCount> by_visible_share;  ///< Bins of visible_share_bins(); the last one: share unknown.
  std::map<std::string, int> lost_at;
  StageTimes times;                      ///< Sums over the views.
  std::vector<double> mean_view_wall_s;  ///< Per number of the view in its sequence, mean over the sequences (Fig. 7).

  /// Detections at places left, per such place: how many views long an object is reported where it has left (Fig. 5).
  [[nodiscard]] double ghosts_per_change() const;
};

/// Lower ends of the bins of the visible share.
[[nodiscard]] std::span<const double> visible_share_bins();

/// Sums the runs of each configuration (micro average over all views of all sequences), in order of preset as first
/// seen, clustering, K. The order of the runs does not matter but for that.
[[nodiscard]] std::vector<ConfigurationSummary> summarize_runs(std::span<const EvaluatedRun> runs);

}  // namespace resight
