// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <vector>

#include "resight/hypotheses/consistency_graph.hpp"

namespace resight {

struct FindCliquesOptions {
  int min_size = 5;
  int max_steps = 20000;  ///< Of the exact search (nodes of its tree); then greedy for what it did not reach.
  void check() const;
};

struct FindCliquesResult {
  std::vector<std::vector<int>> cliques;  ///< Each ascending; largest first, then in lexicographic order; no two alike.
  bool complete = true;                   ///< All maximal cliques of at least min_size; false if the budget ran out.
  int num_steps = 0;
};

/// Maximal cliques of at least min_size vertices: Bron-Kerbosch with Tomita's pivot (2006) over a degeneracy order
/// (Eppstein, Löffler, Strash 2010), from the densest part of the graph outwards, so that a budget that runs out has
/// been spent where the large cliques are. Then one greedy clique from each vertex that the search did not reach,
/// unless it is in some of them already. Deterministic: the budget counts steps, not time.
[[nodiscard]] FindCliquesResult find_cliques(const BitGraph& graph, const FindCliquesOptions& options = {});

}  // namespace resight
