// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <span>
#include <vector>

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
  double max_translation_m = 0.02;  ///< delta_t; paper: 2 cm. Between the objects' centres (the paper: model origins).
  double max_rotation_rad = 0.174533;  ///< delta_r; paper: 10 deg.
  RotationTest rotation_test = RotationTest::kGeodesic;
  EstimatePoseOptions pose{};  ///< Of the final RANSAC over all correspondences of a cluster.
  int num_threads = 1;         ///< Same bits for any value >= 1.
  void check() const;
};

/// Merged hypotheses and their members.
struct ClusterResult {
  /// One per cluster, with the id of its seed and its newest origin view; correspondences pooled without duplicates.
  std::vector<Hypothesis> hypotheses;
  std::vector<std::vector<int>>
      /// Indices of the input per cluster: the seed, then the others in seed order.
      members;
};

/// Merges neighbouring hypotheses of one object (paper, Eq. 1). World frame. Seeds are taken in a defined order (most
/// correspondences, then newest view, then smallest id) instead of the paper's random one, so that with unique ids the
/// order of the input does not matter. Both limits are exclusive, as in the paper. For symmetric objects, the member's
/// pose is replaced by the equivalent pose nearest to the seed, and the model side of its correspondences is moved
/// accordingly.
///
/// The pose of a cluster is re-estimated from all its correspondences. If that fails or leaves the seed's
/// neighbourhood, the seed's pose stays. A cluster of one equals its seed. Throws std::invalid_argument if an object is
/// not in the library.
[[nodiscard]] ClusterResult cluster_hypotheses(std::span<const Hypothesis> hypotheses, const ModelLibrary& library,
                                               const ClusterHypothesesOptions& options = {});

/// Appends the hypothesis' correspondences. Their model side is moved by the symmetry motion that turns its pose into
/// the equivalent one: equivalent_pose * moved point = world_from_object * point.
void append_correspondences(std::vector<Correspondence>& pool, const Hypothesis& hypothesis,
                            const Rigid3& equivalent_pose);

/// Rotation part of Eq. (1) for two rotations of one frame: difference below `max_rotation_rad` as measured by `test`.
[[nodiscard]] bool rotations_are_near(const Eigen::Matrix3d& a, const Eigen::Matrix3d& b, double max_rotation_rad,
                                      RotationTest test);

}  // namespace resight
