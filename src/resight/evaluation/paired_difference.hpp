// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <span>
#include <string>
#include <vector>

#include "resight/evaluation/evaluated_run.hpp"

namespace resight {

/// Mean of the differences b - a over pairs, and its standard error (sample deviation over the root of the number of
/// pairs; NaN for fewer than two). Pairs with a NaN are left out.
struct PairedDifference {
  int num_pairs = 0;
  double mean = 0;
  double standard_error = 0;
};
[[nodiscard]] PairedDifference paired_difference(std::span<const double> a, std::span<const double> b);

/// Preset `b` against preset `a` for one K, sequence by sequence: what differs between sequences cancels out.
struct PresetComparison {
  std::string a;
  std::string b;
  int num_previous_views = 0;
  PairedDifference precision;
  PairedDifference recall;
  PairedDifference f_score;
  PairedDifference strict_f_score;
  PairedDifference ghosts_per_change;
};

/// Every preset against the first one, for each K, over the sequences that both have run on (with clustering).
[[nodiscard]] std::vector<PresetComparison> compare_presets(std::span<const EvaluatedRun> runs);

}  // namespace resight
