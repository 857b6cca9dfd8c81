// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <span>
#include <string>
#include <vector>

#include "resight/evaluation/evaluated_run.hpp"
#include "resight/evaluation/recognition_score.hpp"

namespace resight {

/// Mean of the differences b - a over pairs and its standard error (sample deviation over the square root of the number
/// of pairs; NaN for fewer than two pairs). Pairs with a NaN are skipped.
struct PairedDifference {
  int num_pairs = 0;
  double mean = 0;
  double standard_error = 0;
};
/// Throws std::invalid_argument if the lengths differ.
[[nodiscard]] PairedDifference paired_difference(std::span<const double> a, std::span<const double> b);

/// Preset `b` against preset `a` for one K, paired by sequence, which cancels differences between sequences.
struct PresetComparison {
  std::string a;
  std::string b;
  int num_previous_views = 0;
  int num_sequences = 0;  ///< That both were run on. Where one of them reports nothing, it has no precision.
  PairedDifference precision;
  PairedDifference recall;
  PairedDifference f_score;
  PairedDifference strict_f_score;
  PairedDifference ghosts_per_change;
  PairedDifference event_f_score;           ///< Only sequences on which both presets detected changes.
  PairedDifference log_cpu;                 ///< Of the CPU times of all stages: log(time of b / time of a).
  RecognitionScore score_of_a, score_of_b;  ///< Sums over the pairs.
};

/// Compares every preset with the first one, for each K, over the sequences that both were run on (with clustering).
[[nodiscard]] std::vector<PresetComparison> compare_presets(std::span<const EvaluatedRun> runs);

}  // namespace resight
