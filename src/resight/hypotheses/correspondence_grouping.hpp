// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <numbers>
#include <optional>
#include <span>
#include <vector>

#include "resight/core/options.hpp"
#include "resight/registration/pose_estimation.hpp"

namespace resight {

struct GroupCorrespondencesOptions {
  double max_distance_difference_m = 0.015;
  double max_dot_difference = 0.2;
  double min_distance_m = 0.005;
  int min_group_size = 5;
  int max_correspondences = 1000;
  int max_cliques = 20000;
  int max_poses = 500;
  int max_uses = 3;
  bool expand_groups = true;
  std::optional<double> merge_distance_m = 0.015;
  double merge_rotation_rad = 0.174533;
  EstimatePoseOptions pose{};
  void check() const { check_options("GroupCorrespondencesOptions", *this); }
};

inline void declare(OptionVisitor& v, GroupCorrespondencesOptions& o) {
  v.field(
      "max_distance_difference_m", o.max_distance_difference_m, positive(),
      "Two correspondences are consistent if the distances of their model points and of their scene points differ by "
      "less.",
      "V4R");
  v.field("max_dot_difference", o.max_dot_difference, positive(),
          "The dot products of the normals of two consistent correspondences, in the model and in the scene, differ by "
          "less.",
          "V4R");
  v.field("min_distance_m", o.min_distance_m, at_least(0),
          "Pairs of points nearer to each other do not constrain a pose.");
  v.field("min_group_size", o.min_group_size, at_least(3), "Smaller groups of consistent correspondences are dropped.",
          "V4R");
  v.field("max_correspondences", o.max_correspondences, at_least(1),
          "Correspondences kept per object, by descriptor distance.");
  v.field("max_cliques", o.max_cliques, at_least(0),
          "Budget of the clique search in steps, not in time; greedy afterwards. 0: greedy only.");
  v.field("max_poses", o.max_poses, at_least(1), "Poses estimated per object, from the largest cliques.");
  v.field("max_uses", o.max_uses, at_least(1), "A correspondence may be part of at most this many groups.", "V4R");
  v.field("expand_groups", o.expand_groups, "A group also takes all other correspondences that agree with its pose.",
          "ours");
  v.field(
      "merge_distance_m", o.merge_distance_m, positive(),
      "Of two groups nearer than this (at the middle of their points), only the larger is kept. off: both are (V4R).",
      "ours");
  v.only_if(o.merge_distance_m.has_value(), "merge_distance_m", "a number", [&] {
    v.field("merge_rotation_rad", o.merge_rotation_rad, between(0, std::numbers::pi),
            "Largest angle between two groups that are merged.", "ours");
  });
  v.group("pose", o.pose);
}

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
