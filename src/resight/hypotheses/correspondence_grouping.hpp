// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <span>
#include <vector>

#include "resight/hypotheses/hypothesis.hpp"
#include "resight/registration/pose_estimation.hpp"

namespace resight {

struct GroupCorrespondencesOptions {
  double max_distance_difference_m = 0.015;  ///< | |m_i - m_j| - |s_i - s_j| | below this (V4R: 1.5 cm).
  double max_dot_difference = 0.2;           ///< Of the normals' dot products (V4R: 0.2).
  double min_distance_m = 0.005;             ///< Pairs nearer than this say nothing on the pose.
  int min_group_size = 5;                    ///< V4R: 5.
  int max_correspondences = 1000;            ///< Per object; the best by descriptor distance are kept.
  int max_cliques = 20000;          ///< Budget of the clique search in steps, never in milliseconds; then greedy.
  int max_poses = 500;              ///< Estimated from cliques, the largest first: the other part of the budget.
  int max_uses = 3;                 ///< A correspondence may serve in this many groups (V4R: 3).
  bool expand_groups = true;        ///< Also take the correspondences outside a clique that agree with its pose (ours).
  double merge_distance_m = 0.015;  ///< Of two groups nearer than this (at the middle of their points) and
  double merge_rotation_rad = 0.174533;  ///< nearer than this, only the larger is kept; 0 keeps both (V4R).
  EstimatePoseOptions pose{};
  void check() const;
};

/// Correspondences that agree with one pose of an object.
struct CorrespondenceGroup {
  std::vector<int> members;  ///< Inliers of the pose: ascending indices of the input.
  Rigid3 scene_from_object;
};

/// Groups the correspondences of ONE object into instances, largest group first (paper, Sec. III-A; [11]): consistency
/// graph (edge: distances and normals agree, no shared keypoint), maximal cliques, and one pose per clique.
/// Correspondences with a NaN point are ignored.
///
/// A group has at least min_group_size and pose.min_inliers members, and no two of them share a keypoint. Deviations
/// from V4R:
/// - The budget of the clique search counts steps, not milliseconds.
/// - Cliques are processed largest first, not in reverse order of discovery.
/// - Poses are checked by distance AND normal of every inlier (V4R: the normal of one inlier).
/// - expand_groups and merge_* are ours.
[[nodiscard]] std::vector<CorrespondenceGroup> group_correspondences(std::span<const Correspondence> correspondences,
                                                                     const GroupCorrespondencesOptions& options = {});

/// Ascending indices of at most `max_count` correspondences with finite points. The best by descriptor distance are
/// chosen, alternating between feature types, because distances in two descriptor spaces are not comparable.
[[nodiscard]] std::vector<int> select_best_correspondences(std::span<const Correspondence> correspondences,
                                                           int max_count);

}  // namespace resight
