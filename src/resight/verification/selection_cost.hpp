// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "resight/verification/cues.hpp"
#include "resight/verification/occupancy.hpp"

namespace resight {

/// Costs as integers in units of 2^-24. Sums are exact, so incremental costs equal recomputed ones and the order of
/// additions does not matter.
using FixedCost = std::int64_t;
inline constexpr double kFixedOne = 16777216.0;
[[nodiscard]] FixedCost to_fixed(double cost);
[[nodiscard]] inline double from_fixed(FixedCost cost) { return static_cast<double>(cost) / kFixedOne; }

/// Cost that does not depend on other hypotheses, and total cost if nothing else is chosen.
[[nodiscard]] double own_cost(const HypothesisEvidence& evidence);
[[nodiscard]] double unary_cost(const HypothesisEvidence& evidence);

/// A scene point and how much a hypothesis explains it or is charged for leaving it, 2^16 a unit.
struct FixedWeight {
  int point = -1;
  std::int32_t explained = 0;  ///< Either this is positive...
  std::int32_t clutter = 0;    ///< ...or this.
};

/// The choice of a set of n candidates.
struct SelectionProblem {
  /// A pair of candidates costs this when both are active.
  struct Conflict {
    int other = -1;
    FixedCost cost = 0;
  };
  std::vector<FixedCost> unary;                   ///< Per candidate: all that does not depend on the others.
  std::vector<std::vector<FixedWeight>> weights;  ///< Per candidate: points that it shares with another, ascending.
  std::vector<std::vector<Conflict>> conflicts;   ///< Per candidate, ascending; symmetric.
  int num_points = 0;                             ///< Points are numbered from 0.
  FixedCost duplicity_scale = 256;                ///< duplicity_weight times 2^8.
  DuplicityRule duplicity_rule = DuplicityRule::kBeyondBest;

  [[nodiscard]] int num_candidates() const { return static_cast<int>(unary.size()); }
};

/// Points of one candidate only are folded into its unary cost.
[[nodiscard]] SelectionProblem make_selection_problem(std::span<const HypothesisCues* const> candidates,
                                                      std::span<const SharedVoxels> shared_voxels,
                                                      const SelectionOptions& options);

/// The set and its cost, kept up to date under changes of one candidate. A change touches the points of that candidate
/// only.
///
/// cost = sum of unary + conflicts + per point: no active candidate explains it: sum of the active clutter weights;
/// else duplicity_weight * (sum of weights - best (kBeyondBest) | sum of weights if two or more (kAllWeights)) - best.
class Selection {
 public:
  explicit Selection(const SelectionProblem& problem);

  [[nodiscard]] bool is_active(int candidate) const { return active_[candidate] != 0; }
  [[nodiscard]] const std::vector<std::uint8_t>& active() const { return active_; }
  [[nodiscard]] FixedCost cost() const { return cost_; }
  /// Change of the cost if the candidate were switched.
  [[nodiscard]] FixedCost change_if_switched(int candidate) const;
  void switch_candidate(int candidate);

 private:
  struct PointState {
    std::int32_t num_explaining = 0;
    std::int32_t best = 0;
    std::int64_t clutter = 0;  // Sums of many weights.
    std::int64_t sum = 0;
  };
  struct Explainer {
    int candidate;
    std::int32_t weight;
  };
  [[nodiscard]] FixedCost point_cost(const PointState& state) const;
  [[nodiscard]] PointState switched(const FixedWeight& weight, int candidate, bool activate) const;
  [[nodiscard]] std::int32_t best_without(int point, int candidate) const;
  [[nodiscard]] FixedCost unary_change(int candidate) const;

  const SelectionProblem& problem_;
  std::vector<std::uint8_t> active_;
  std::vector<PointState> points_;
  std::vector<int> explainer_begin_;  // CSR: candidates that explain each point.
  std::vector<Explainer> explainers_;
  FixedCost cost_ = 0;
};

}  // namespace resight
