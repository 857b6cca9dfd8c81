// SPDX-License-Identifier: Apache-2.0
#include "resight/recognition/hypothesis_pool.hpp"

#include <algorithm>
#include <iterator>
#include <unordered_set>
#include <utility>

namespace resight {
namespace {

// Apart from the ids of views, which are the same for all recognisers that share a ViewHypothesisStore.
constexpr std::uint64_t kFirstTrackedId = 1ULL << 40;

}  // namespace

void HypothesisPool::add_view(std::vector<Hypothesis> hypotheses, std::span<const int> window) {
  hypotheses_of_view_.insert_or_assign(window.back(), std::move(hypotheses));
  std::erase_if(hypotheses_of_view_,
                [&](const auto& entry) { return std::ranges::find(window, entry.first) == window.end(); });
}

std::vector<Hypothesis> HypothesisPool::merge(std::vector<Hypothesis> tracked) {
  std::vector<Hypothesis> merged;
  for (const auto& [view, of_view] : hypotheses_of_view_) merged.insert(merged.end(), of_view.begin(), of_view.end());
  for (Hypothesis& hypothesis : tracked) {
    hypothesis.id = kFirstTrackedId + num_tracked_ids_++;
    merged.push_back(std::move(hypothesis));
  }
  return merged;
}

std::vector<Hypothesis> HypothesisPool::cluster(std::vector<Hypothesis> merged) {
  members_of_cluster_.clear();
  if (!clustering_) {
    for (const Hypothesis& h : merged) members_of_cluster_[h.id] = {h.id};
    return merged;
  }
  ClusterResult clusters = cluster_hypotheses(merged, library_, *clustering_, pose_);
  for (std::size_t c = 0; c < clusters.hypotheses.size(); ++c)
    for (const int m : clusters.members[c])
      members_of_cluster_[clusters.hypotheses[c].id].push_back(merged[static_cast<std::size_t>(m)].id);
  return std::move(clusters.hypotheses);
}

bool HypothesisPool::is_tracked(const Hypothesis& clustered) const {
  return std::ranges::any_of(members_of_cluster_.at(clustered.id),
                             [](std::uint64_t id) { return id >= kFirstTrackedId; });
}

std::vector<Hypothesis> HypothesisPool::members_of_newest_view(std::uint64_t clustered_id) const {
  const std::vector<std::uint64_t>& members = members_of_cluster_.at(clustered_id);
  std::vector<Hypothesis> found;
  std::ranges::copy_if(hypotheses_of_view_.rbegin()->second, std::back_inserter(found),
                       [&](const Hypothesis& h) { return std::ranges::find(members, h.id) != members.end(); });
  return found;
}

bool HypothesisPool::is_tracked_object_rejected(std::span<const Hypothesis> clustered,
                                                std::span<const HypothesisEvidence> evidence) const {
  for (std::size_t h = 0; h < clustered.size(); ++h) {
    const Verdict verdict = evidence[h].verdict;
    const bool is_rejected =
        verdict == Verdict::kNoSupport || verdict == Verdict::kDifferentAppearance || verdict == Verdict::kCost;
    if (is_rejected && is_tracked(clustered[h])) return true;
  }
  return false;
}

void HypothesisPool::forget_refuted(std::span<const Hypothesis> clustered, std::span<const HypothesisEvidence> evidence,
                                    double min_explained_share) {
  if (min_explained_share <= 0) return;
  std::unordered_set<std::uint64_t> refuted;
  for (std::size_t h = 0; h < clustered.size(); ++h) {
    const Verdict verdict = evidence[h].verdict;
    if (verdict == Verdict::kTooFewVisible) continue;
    if (verdict != Verdict::kDifferentAppearance && evidence[h].explained_share >= min_explained_share) continue;
    const std::vector<std::uint64_t>& members = members_of_cluster_.at(clustered[h].id);
    refuted.insert(members.begin(), members.end());
  }
  for (auto& [view, of_view] : hypotheses_of_view_)
    std::erase_if(of_view, [&](const Hypothesis& h) { return refuted.contains(h.id); });
}

}  // namespace resight
