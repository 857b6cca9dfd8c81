// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <unordered_map>
#include <vector>

#include "resight/hypotheses/clustering.hpp"
#include "resight/hypotheses/hypothesis.hpp"
#include "resight/models/object_model.hpp"
#include "resight/verification/hypothesis_evidence.hpp"

namespace resight {

/// Merges and clusters the hypotheses of the last views and of the tracked objects (paper, Sec. III-A). World frame:
/// carrying hypotheses over to the next view is collecting them. Ids of the hypotheses of views must be below 2^40.
class HypothesisPool {
 public:
  /// `clustering`: none = hypotheses are not clustered. `pose`: of clusters. `library` must outlive the pool.
  HypothesisPool(const ModelLibrary& library, std::optional<ClusterHypothesesOptions> clustering,
                 const EstimatePoseOptions& pose = {})
      : library_(library), clustering_(clustering), pose_(pose) {}

  /// Adds the hypotheses of the current view, the last of `window`, and forgets those of views outside the window.
  void add_view(std::vector<Hypothesis> hypotheses, std::span<const int> window);
  /// All hypotheses of the window, oldest view first, then the tracked ones. These get ids above all others, in order:
  /// where hypotheses tie, those of views come first.
  [[nodiscard]] std::vector<Hypothesis> merge(std::vector<Hypothesis> tracked);
  /// Clusters the result of merge() (paper, Eq. 1) and remembers the members of each cluster.
  [[nodiscard]] std::vector<Hypothesis> cluster(std::vector<Hypothesis> merged);

  /// Whether a tracked object is a member. The hypothesis must be a result of the last cluster(), here and below.
  [[nodiscard]] bool is_tracked(const Hypothesis& clustered) const;
  /// The members of a cluster, given by its id, that the current view itself has generated.
  [[nodiscard]] std::vector<Hypothesis> members_of_newest_view(std::uint64_t clustered_id) const;
  /// Whether a tracked object is visible and was rejected nevertheless. `evidence`: one per hypothesis, here and below.
  [[nodiscard]] bool is_tracked_object_rejected(std::span<const Hypothesis> clustered,
                                                std::span<const HypothesisEvidence> evidence) const;
  /// Forgets the members of all clusters that were visible, and whose texture differs or whose explained share is below
  /// `min_explained_share`: they are spurious and not carried over to the next views. 0 = none.
  void forget_refuted(std::span<const Hypothesis> clustered, std::span<const HypothesisEvidence> evidence,
                      double min_explained_share);

 private:
  const ModelLibrary& library_;
  std::optional<ClusterHypothesesOptions> clustering_;
  EstimatePoseOptions pose_;
  std::map<int, std::vector<Hypothesis>> hypotheses_of_view_;
  std::unordered_map<std::uint64_t, std::vector<std::uint64_t>> members_of_cluster_;  // Ids, by the id of the cluster.
  std::uint64_t num_tracked_ids_ = 0;
};

}  // namespace resight
