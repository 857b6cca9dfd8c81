// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <vector>

#include "resight/verification/selection_cost.hpp"

namespace resight {

struct SearchSelectionResult {
  std::vector<std::uint8_t> active;  ///< 0/1 per candidate.
  FixedCost cost = 0;
  int num_moves = 0;  ///< Accepted moves of the local searches.
  int num_components = 0;
  bool is_optimal = true;  ///< Every component was enumerated.
};

/// Connected components of the candidates (sharing a point or a conflict), ascending by their smallest member.
[[nodiscard]] std::vector<std::vector<int>> find_components(const SelectionProblem& problem);

/// The cheapest set: small components by enumeration in Gray code order (one switch a set), large ones by local search
/// from the empty set and from a greedy one, taking the first improving move of a shuffled list of activate, deactivate
/// and replace moves ([11]), until none improves. Ties go to the set found first, the empty one before all.
[[nodiscard]] SearchSelectionResult search_selection(const SelectionProblem& problem,
                                                     const SelectionOptions& options = {}, std::uint64_t seed = 1);

}  // namespace resight
