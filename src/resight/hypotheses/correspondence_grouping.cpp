// SPDX-License-Identifier: Apache-2.0
#include "resight/hypotheses/correspondence_grouping.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <tuple>

#include "resight/core/check.hpp"
#include "resight/hypotheses/consistency_graph.hpp"
#include "resight/hypotheses/maximal_cliques.hpp"

namespace resight {
namespace {

// A clique is skipped if all but this many of its members agree with one accepted pose: too few remain for another
// pose.
constexpr int kMaxFreeMembers = 2;

struct Candidate {
  PoseEstimate estimate;  // Its inliers are positions in the kept correspondences.
  Eigen::Vector3d middle_in_object = Eigen::Vector3d::Zero();
};

bool shares_keypoint(const Correspondence& a, const Correspondence& b) {
  return a.type == b.type && ((a.model_feature >= 0 && a.model_feature == b.model_feature) ||
                              (a.scene_feature >= 0 && a.scene_feature == b.scene_feature));
}

float descriptor_distance_sq(const Correspondence& c) {
  // Unknown distances come last.
  return std::isnan(c.distance_sq) ? std::numeric_limits<float>::infinity() : c.distance_sq;
}

// Processes the cliques of one object and collects the resulting groups.
class GroupCollector {
 public:
  GroupCollector(std::span<const Correspondence> kept, const GroupCorrespondencesOptions& options)
      : kept_(kept), options_(options), pose_options_(options.pose), num_uses_(kept.size(), 0) {
    pose_options_.min_inliers = std::max(options.pose.min_inliers, options.min_group_size);
  }

  void add_clique(const std::vector<int>& clique) {
    if (num_estimates_ == options_.max_poses) return;
    std::vector<int> members;
    for (const int i : clique)
      if (num_uses_[static_cast<std::size_t>(i)] < options_.max_uses) members.push_back(i);
    if (static_cast<int>(members.size()) < pose_options_.min_inliers || is_explained(members)) return;
    ++num_estimates_;
    auto candidate = estimate(members);
    if (!candidate || is_repeated(*candidate)) return;
    accept(std::move(*candidate));
  }

  [[nodiscard]] std::vector<Candidate> take() {
    std::stable_sort(accepted_.begin(), accepted_.end(), [](const Candidate& a, const Candidate& b) {
      const auto size_a = a.estimate.inliers.size();
      const auto size_b = b.estimate.inliers.size();
      return size_a != size_b ? size_a > size_b : a.estimate.rms_m < b.estimate.rms_m;
    });
    return std::move(accepted_);
  }

 private:
  [[nodiscard]] bool is_explained(const std::vector<int>& members) const {
    if (!options_.merge_distance_m) return false;
    return std::any_of(agrees_.begin(), agrees_.end(), [&](const std::vector<std::uint8_t>& agrees) {
      int num_free = 0;
      for (const int i : members) num_free += agrees[static_cast<std::size_t>(i)] == 0 ? 1 : 0;
      return num_free <= kMaxFreeMembers;
    });
  }

  // Estimates a pose from a subset of the kept correspondences. Inliers are positions in all kept ones.
  template <typename Estimate>
  [[nodiscard]] std::optional<PoseEstimate> over_subset(const std::vector<int>& subset,
                                                        Estimate&& estimate_subset) const {
    std::vector<Correspondence> chosen;
    chosen.reserve(subset.size());
    for (const int i : subset) chosen.push_back(kept_[static_cast<std::size_t>(i)]);
    std::optional<PoseEstimate> result = estimate_subset(chosen);
    if (result)
      for (int& i : result->inliers) i = subset[static_cast<std::size_t>(i)];
    return result;
  }

  // All correspondences that agree with the pose. If several share a keypoint, the one with the smallest residual is
  // kept.
  [[nodiscard]] std::vector<int> agreeing(const Rigid3& pose) const {
    const std::vector<float> residuals = inlier_residuals_sq(kept_, pose, pose_options_);
    std::vector<int> order;
    for (std::size_t i = 0; i < residuals.size(); ++i)
      if (std::isfinite(residuals[i]) && num_uses_[i] < options_.max_uses) order.push_back(static_cast<int>(i));
    std::stable_sort(order.begin(), order.end(), [&](int a, int b) {
      return residuals[static_cast<std::size_t>(a)] < residuals[static_cast<std::size_t>(b)];
    });
    std::vector<int> chosen;
    for (const int i : order) {
      const Correspondence& c = kept_[static_cast<std::size_t>(i)];
      if (std::none_of(chosen.begin(), chosen.end(),
                       [&](int other) { return shares_keypoint(c, kept_[static_cast<std::size_t>(other)]); }))
        chosen.push_back(i);
    }
    std::sort(chosen.begin(), chosen.end());
    return chosen;
  }

  [[nodiscard]] std::optional<Candidate> estimate(const std::vector<int>& members) const {
    auto pose = over_subset(members, [&](const auto& chosen) { return estimate_pose(chosen, pose_options_); });
    if (pose && options_.expand_groups) {
      auto expanded = over_subset(agreeing(pose->scene_from_model), [&](const auto& chosen) {
        return refine_pose(chosen, pose->scene_from_model, pose_options_);
      });
      if (expanded && expanded->inliers.size() >= pose->inliers.size()) pose = std::move(expanded);
    }
    if (!pose) return std::nullopt;
    Candidate candidate;
    for (const int i : pose->inliers)
      candidate.middle_in_object += kept_[static_cast<std::size_t>(i)].model_point.cast<double>();
    candidate.middle_in_object /= static_cast<double>(pose->inliers.size());
    candidate.estimate = std::move(*pose);
    return candidate;
  }

  [[nodiscard]] bool is_repeated(const Candidate& candidate) const {
    if (!options_.merge_distance_m) return false;
    const Rigid3& pose = candidate.estimate.scene_from_model;
    return std::any_of(accepted_.begin(), accepted_.end(), [&](const Candidate& other) {
      const Rigid3& other_pose = other.estimate.scene_from_model;
      const Eigen::Vector3d offset = pose * candidate.middle_in_object - other_pose * candidate.middle_in_object;
      return offset.norm() < *options_.merge_distance_m &&
             rotation_angle_rad(pose.rotation, other_pose.rotation) < options_.merge_rotation_rad;
    });
  }

  void accept(Candidate candidate) {
    const std::vector<float> residuals = inlier_residuals_sq(kept_, candidate.estimate.scene_from_model, pose_options_);
    std::vector<std::uint8_t> agrees(kept_.size());
    std::transform(residuals.begin(), residuals.end(), agrees.begin(),
                   [](float r) { return std::isfinite(r) ? 1 : 0; });
    agrees_.push_back(std::move(agrees));
    for (const int i : candidate.estimate.inliers) ++num_uses_[static_cast<std::size_t>(i)];
    accepted_.push_back(std::move(candidate));
  }

  std::span<const Correspondence> kept_;
  const GroupCorrespondencesOptions& options_;
  EstimatePoseOptions pose_options_;
  std::vector<int> num_uses_;
  int num_estimates_ = 0;
  std::vector<Candidate> accepted_;
  // Agreement with the pose of each accepted group, per kept correspondence.
  std::vector<std::vector<std::uint8_t>> agrees_;
};

// Vertices that can belong to a clique of the required size, and their graph.
struct Pruned {
  std::vector<int> vertices;
  BitGraph graph;
};

Pruned prune_to_core(const BitGraph& graph, int min_clique_size) {
  const Degeneracy degeneracy = degeneracy_order(graph);
  Pruned pruned;
  for (int v = 0; v < graph.num_vertices(); ++v)
    if (degeneracy.core[static_cast<std::size_t>(v)] + 1 >= min_clique_size) pruned.vertices.push_back(v);
  pruned.graph = graph.subgraph(pruned.vertices);
  return pruned;
}

}  // namespace

std::vector<int> select_best_correspondences(std::span<const Correspondence> correspondences, int max_count) {
  check_positive("max_count", max_count);
  std::array<std::vector<int>, 2> of_type;
  for (std::size_t i = 0; i < correspondences.size(); ++i) {
    const Correspondence& c = correspondences[i];
    if (c.model_point.allFinite() && c.scene_point.allFinite())
      of_type[c.type == FeatureType::kShot ? 1 : 0].push_back(static_cast<int>(i));
  }
  using Key = std::tuple<std::size_t, std::size_t, int>;  // Rank within the type, type, index.
  std::vector<Key> ranked;
  for (std::size_t type = 0; type < of_type.size(); ++type) {
    std::vector<int>& indices = of_type[type];
    std::stable_sort(indices.begin(), indices.end(), [&](int a, int b) {
      return descriptor_distance_sq(correspondences[static_cast<std::size_t>(a)]) <
             descriptor_distance_sq(correspondences[static_cast<std::size_t>(b)]);
    });
    for (std::size_t rank = 0; rank < indices.size(); ++rank) ranked.emplace_back(rank, type, indices[rank]);
  }
  std::sort(ranked.begin(), ranked.end());
  ranked.resize(std::min(ranked.size(), static_cast<std::size_t>(max_count)));
  std::vector<int> chosen;
  for (const auto& [rank, type, index] : ranked) chosen.push_back(index);
  std::sort(chosen.begin(), chosen.end());
  return chosen;
}

std::vector<CorrespondenceGroup> group_correspondences(std::span<const Correspondence> correspondences,
                                                       const GroupCorrespondencesOptions& options) {
  options.check();
  const std::vector<int> chosen = select_best_correspondences(correspondences, options.max_correspondences);
  std::vector<Correspondence> kept;
  kept.reserve(chosen.size());
  for (const int i : chosen) kept.push_back(correspondences[static_cast<std::size_t>(i)]);

  const Pruned pruned =
      prune_to_core(build_consistency_graph(kept, {.max_distance_difference_m = options.max_distance_difference_m,
                                                   .max_dot_difference = options.max_dot_difference,
                                                   .min_distance_m = options.min_distance_m}),
                    options.min_group_size);
  FindCliquesResult found =
      find_cliques(pruned.graph, {.min_size = options.min_group_size, .max_steps = options.max_cliques});
  GroupCollector collector(kept, options);
  for (std::vector<int>& clique : found.cliques) {
    for (int& i : clique) i = pruned.vertices[static_cast<std::size_t>(i)];
    collector.add_clique(clique);
  }
  std::vector<CorrespondenceGroup> groups;
  for (Candidate& candidate : collector.take()) {
    CorrespondenceGroup group{std::move(candidate.estimate.inliers), candidate.estimate.scene_from_model};
    for (int& i : group.members) i = chosen[static_cast<std::size_t>(i)];
    groups.push_back(std::move(group));
  }
  return groups;
}

}  // namespace resight
