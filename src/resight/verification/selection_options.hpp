// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>

#include "resight/core/options.hpp"

namespace resight {

/// What a scene point costs that several accepted hypotheses explain.
enum class DuplicityRule : std::uint8_t {
  kBeyondBest,  ///< All weights but the largest. Ours: what touches another object pays only for the overlap.
  kAllWeights,  ///< All weights, the largest included (V4R's mode 2): such a point is worse than an unexplained one.
};

/// Costs of a set of hypotheses, and the search for the cheapest.
struct SelectionOptions {
  double outlier_weight = 1.0;
  double duplicity_weight = 1.0;
  DuplicityRule duplicity_rule = DuplicityRule::kBeyondBest;
  double occupancy_weight = 2.0;
  double score_power = 0;
  int max_moves = 5000;
  int max_exact_hypotheses = 12;
  void check() const { check_options("SelectionOptions", *this); }
};

inline void declare(OptionVisitor& v, SelectionOptions& o) {
  v.field("outlier_weight", o.outlier_weight, between(0, 1000), "Cost of a visible model point that nothing explains.");
  v.field("duplicity_weight", o.duplicity_weight, between(0, 1000),
          "Cost of a scene point that several hypotheses explain.");
  v.choice("duplicity_rule", o.duplicity_rule,
           {{"beyond_best", "all weights but the largest"}, {"all_weights", "all weights (V4R)"}},
           "Which weights of a point that several hypotheses explain are charged.");
  v.field("occupancy_weight", o.occupancy_weight, between(0, 1e6),
          "Cost of a voxel that the surfaces of two objects fill. 0: objects may interpenetrate.");
  v.field("score_power", o.score_power, between(0, 10),
          "What a hypothesis explains is multiplied by its score to this power: of two hypotheses that explain the "
          "same, the more likely one is accepted. 0: the score does not count.",
          "ours");
  v.field(
      "max_moves", o.max_moves, at_least(0),
      "Accepted moves of each of the two local searches (from no hypothesis, and from a greedy choice) per connected "
      "component of hypotheses: a budget in steps, not in time.",
      "Aldoma et al. 2015, the paper's [11]");
  v.field("max_exact_hypotheses", o.max_exact_hypotheses, between(0, 20),
          "Components up to this size are solved exactly, by enumeration of all sets.", "ours");
}

}  // namespace resight
