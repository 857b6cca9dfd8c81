// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <map>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "resight/evaluation/evaluated_run.hpp"
#include "resight/evaluation/reliability.hpp"

namespace resight {

/// Found and missed objects of one group (by name, or by visible share).
struct FoundCount {
  int found = 0;
  int missed = 0;
  int false_positives = 0;             ///< By name only; includes ghosts.
  std::map<std::string, int> lost_at;  ///< Missed objects per stage.
};

/// Median and 95 % quantile of errors.
struct ErrorQuantiles {
  int count = 0;
  double median = 0;  ///< NaN without values.
  double p95 = 0;
};
/// Nearest-rank quantiles: the p-quantile of n values is the ceil(p n)-th smallest.
[[nodiscard]] ErrorQuantiles error_quantiles(std::vector<double> values);

/// Errors of the true positives within the loose limits.
struct PoseErrorSummary {
  ErrorQuantiles center_m;
  ErrorQuantiles rotation_rad;
};

/// Ghosts, summed over the sequences.
struct GhostSummary {
  int num_detections = 0;
  int num_former_places = 0;
  int num_by_published_rule = 0;  ///< count_detected_former_places(), summed over the views.
  int num_published_places = 0;   ///< Former places by that rule; EvaluatedRun::num_published_places.
  /// Ghost detections per former place: the number of views in which an object is still reported at a place it has left
  /// (paper, Fig. 5).
  [[nodiscard]] double per_former_place() const;
};

/// Changes, summed over the sequences with true changes.
struct ChangeSummary {
  bool are_scored = false;  ///< With change detection and true changes.
  ChangePointScores points;
  EventScore events;
};

/// Found and missed objects.
struct FoundSummary {
  std::map<std::string, FoundCount> by_object;
  /// Bins of visible_share_bins(); the last one is for unknown shares.
  std::vector<FoundCount> by_visible_share;
  std::map<std::string, int> lost_at;
};

struct TimeSummary {
  StageTimes stages;            ///< Sums over the views.
  std::set<int> num_threads{};  ///< That the runs were measured with.
  /// Per view number, mean over the sequences (paper, Fig. 7).
  std::vector<double> mean_view_wall_s;
};

/// Summary of one configuration over all sequences of an evaluation.
struct ConfigurationSummary {
  std::string preset;
  int num_previous_views = 0;  ///< K.
  bool is_clustered = true;
  int num_sequences = 0;
  int num_views = 0;
  RecognitionScore score;         ///< Within 5 cm and 30 deg.
  RecognitionScore strict_score;  ///< Within 1 cm and 10 deg.
  PoseErrorSummary errors;
  Reliability reliability;  ///< Of the scores of all detections that are not ignored.
  GhostSummary ghosts;
  HypothesisCounts counts;  ///< Sums over the views.
  ChangeSummary changes;
  FoundSummary found;
  TimeSummary times;
};

/// Lower bounds of the bins of the visible share.
[[nodiscard]] std::span<const double> visible_share_bins();

/// Sums the runs of each configuration (micro average over all views of all sequences). Sorted by preset (in order of
/// appearance), clustering, and K; otherwise independent of the order of the runs.
[[nodiscard]] std::vector<ConfigurationSummary> summarize_runs(std::span<const EvaluatedRun> runs);

}  // namespace resight
