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

/// Cliques found, and whether they are all.
struct FindCliquesResult {
  /// Each ascending; sorted by size (largest first), then lexicographically; no duplicates.
  std::vector<std::vector<int>> cliques;
  /// True if all maximal cliques of at least min_size were found; false if the budget was exhausted.
  bool complete = true;
  int num_steps = 0;
};

/// Maximal cliques of at least min_size vertices: Bron-Kerbosch with Tomita's pivot (2006) over a degeneracy order
/// (Eppstein, Löffler, Strash 2010). The search starts in the densest region, where the large cliques are. If the
/// budget runs out, each vertex that was not reached contributes one greedy clique, unless it is already in several.
/// Deterministic: the budget counts steps, not time.
[[nodiscard]] FindCliquesResult find_cliques(const BitGraph& graph, const FindCliquesOptions& options = {});

}  // namespace resight
