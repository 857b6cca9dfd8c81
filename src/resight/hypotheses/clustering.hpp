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
  kGeodesic,       ///< One angle, below max_rotation_rad. Ours.
  kAbsoluteEuler,  ///< |yaw|, |pitch|, |roll| each below it: the paper's Eq. (1) with the absolute values it lacks.
};

struct ClusterHypothesesOptions {
  double max_translation_m = 0.02;  ///< delta_t; paper: 2 cm. Between the objects' centres (the paper: model origins).
  double max_rotation_rad = 0.174533;  ///< delta_r; paper: 10 deg.
  RotationTest rotation_test = RotationTest::kGeodesic;
  EstimatePoseOptions pose{};  ///< Of the final RANSAC over all correspondences of a cluster.
  int num_threads = 1;         ///< Same bits for any value >= 1.
  void check() const;
};

struct ClusterResult {
  std::vector<Hypothesis> hypotheses;  ///< One a cluster; id of its seed; correspondences pooled without repeats;
                                       ///< newest origin view.
  std::vector<std::vector<int>>
      members;  ///< Indices of the input, per cluster: the seed, then the others in seed order.
};

/// Paper Eq. (1): merges near hypotheses of one object. Seeds in a defined order (most correspondences, then newest,
/// then smallest id) instead of the paper's random one, so that with unique ids the order of the input does not matter;
/// both limits are exclusive, as printed. Symmetric objects by their symmetries: the member's pose is exchanged for the
/// equivalent one nearest to the seed, and the model side of its correspondences is carried along.
///
/// The pose of a cluster is estimated anew over all its correspondences; if that fails or leaves the seed's
/// neighbourhood, the seed's pose stays. A cluster of one is its seed, unchanged. World frame throughout.
[[nodiscard]] ClusterResult cluster_hypotheses(std::span<const Hypothesis> hypotheses, const ModelLibrary& library,
                                               const ClusterHypothesesOptions& options = {});

/// Adds the hypothesis' correspondences, the model side moved by the symmetry that turns its pose into the equivalent
/// one: equivalent_pose * moved point = world_from_object * point.
void append_correspondences(std::vector<Correspondence>& pool, const Hypothesis& hypothesis,
                            const Rigid3& equivalent_pose);

/// The rotation part of Eq. (1) for two rotations of one frame: below `max_rotation_rad` in the sense of `test`.
[[nodiscard]] bool rotations_are_near(const Eigen::Matrix3d& a, const Eigen::Matrix3d& b, double max_rotation_rad,
                                      RotationTest test);

}  // namespace resight
