// SPDX-License-Identifier: Apache-2.0
#include "resight/annotation/matched_regions.hpp"

#include <algorithm>
#include <set>

namespace resight {
namespace {

constexpr double kMinReach_m = 0.02;
constexpr double kReachOfSize = 0.25;

struct RegionPair {
  std::size_t proposal = 0;
  const RegionJudgement* judgement = nullptr;
  double distance_m = 0;
};

std::vector<RegionPair> find_pairs(const AnnotationDocument& document, std::span<const ChangeProposal> proposals) {
  std::vector<RegionPair> pairs;
  for (const auto& [key, judgement] : document.regions) {
    for (std::size_t p = 0; p < proposals.size(); ++p) {
      const RegionKey proposed = proposals[p].key();
      if (proposed.view != key.view || proposed.kind != key.kind) continue;
      const double distance_m = (proposed.center_in_world_m - key.center_in_world_m).norm();
      const double reach_m = std::max(kMinReach_m, kReachOfSize * proposals[p].box.size_m.maxCoeff());
      if (distance_m <= reach_m) pairs.push_back({p, &judgement, distance_m});
    }
  }
  std::ranges::stable_sort(pairs, {}, &RegionPair::distance_m);
  return pairs;
}

}  // namespace

MatchedRegions match_regions(const AnnotationDocument& document, std::span<const ChangeProposal> proposals) {
  MatchedRegions matched;
  matched.of_proposal.resize(proposals.size(), nullptr);
  std::set<const RegionJudgement*> used;
  for (const RegionPair& pair : find_pairs(document, proposals)) {
    if (matched.of_proposal[pair.proposal] != nullptr || !used.insert(pair.judgement).second) continue;
    matched.of_proposal[pair.proposal] = pair.judgement;
  }
  for (const auto& [key, judgement] : document.regions)
    if (!used.contains(&judgement)) matched.unmatched.push_back(&judgement);
  return matched;
}

}  // namespace resight
