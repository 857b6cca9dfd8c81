// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <numbers>
#include <span>
#include <vector>

#include "resight/core/options.hpp"
#include "resight/hypotheses/hypothesis.hpp"
#include "resight/models/object_model.hpp"
#include "resight/registration/pose_estimation.hpp"

namespace resight {

/// How Eq. (1) compares rotations.
enum class RotationTest : std::uint8_t {
  kGeodesic,  ///< Rotation angle below max_rotation_rad. Ours.
  /// |yaw|, |pitch| and |roll| each below max_rotation_rad: the paper's Eq. (1), with the absolute values it omits.
  kAbsoluteEuler,
};

struct ClusterHypothesesOptions {
  double max_translation_m = 0.02;
  double max_rotation_rad = 0.174533;
  RotationTest rotation_test = RotationTest::kGeodesic;
  int num_threads = 1;  ///< Same bits for any value >= 1.
  void check() const { check_options("ClusterHypothesesOptions", *this); }
};

inline void declare(OptionVisitor& v, ClusterHypothesesOptions& o) {
  v.field("max_translation_m", o.max_translation_m, positive(),
          "delta_t: largest distance of two hypotheses of a cluster, at the object's centre.", "paper, Eq. (1)");
  v.field("max_rotation_rad", o.max_rotation_rad, between(1e-9, std::numbers::pi),
          "delta_r: largest angle between the rotations of two hypotheses of a cluster.", "paper, Eq. (1): 10 deg");
  v.choice("rotation_test", o.rotation_test,
           {{"geodesic", "one angle"}, {"absolute_euler", "yaw, pitch and roll separately (paper)"}},
           "What the angle between two rotations is.");
  v.num_threads(o.num_threads);
}

/// Merged hypotheses and their members.
struct ClusterResult {
  /// One per cluster, with the id of its seed and its newest origin view; correspondences pooled without duplicates.
  std::vector<Hypothesis> hypotheses;
  /// Indices of the input per cluster: the seed, then the others in seed order.
  std::vector<std::vector<int>> members;
};

/// Merges neighbouring hypotheses of one object (paper, Eq. 1). World frame. Seeds are taken in a defined order (most
/// correspondences, then newest view, then smallest id) instead of the paper's random one, so that with unique ids the
/// order of the input does not matter. Both limits are exclusive, as in the paper. For symmetric objects, the member's
/// pose is replaced by the equivalent pose nearest to the seed, and the model side of its correspondences is moved
/// accordingly.
///
/// The pose of a cluster is re-estimated from all its correspondences (with `pose`). If that fails or leaves the seed's
/// neighbourhood, the seed's pose stays. A cluster of one equals its seed. Throws std::invalid_argument if an object is
/// not in the library.
[[nodiscard]] ClusterResult cluster_hypotheses(std::span<const Hypothesis> hypotheses, const ModelLibrary& library,
                                               const ClusterHypothesesOptions& options = {},
                                               const EstimatePoseOptions& pose = {});

/// Appends the hypothesis' correspondences. Their model side is moved by the symmetry motion that turns its pose into
/// the equivalent one: equivalent_pose * moved point = world_from_object * point.
void append_correspondences(std::vector<Correspondence>& pool, const Hypothesis& hypothesis,
                            const Rigid3& equivalent_pose);

/// The pool, in its order, with each correspondence once: two groups of one view may share some.
[[nodiscard]] std::vector<Correspondence> without_repeats(std::span<const Correspondence> pool);

/// Rotation part of Eq. (1) for two rotations of one frame: difference below `max_rotation_rad` as measured by `test`.
[[nodiscard]] bool rotations_are_near(const Eigen::Matrix3d& a, const Eigen::Matrix3d& b, double max_rotation_rad,
                                      RotationTest test);

}  // namespace resight
