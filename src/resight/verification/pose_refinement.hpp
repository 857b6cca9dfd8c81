// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <span>

#include "resight/geometry/rigid3.hpp"
#include "resight/hypotheses/hypothesis.hpp"
#include "resight/registration/pose_uncertainty.hpp"

namespace resight {

struct PreparedModel;
struct PreparedScene;

struct RefinePoseOptions {
  int max_iterations = 10;  ///< 0: poses stay as they are.
  double max_distance_m = 0.015;
  double max_normal_angle_rad = 0.785398;  ///< 45 deg.
  double max_step_m = 0.02;  ///< A pose that moves farther in all (at the middle of the points) is left as it was.
  double correspondence_weight = 4;  ///< Of a pair of keypoints, beside 1 of a surface point (at most 300 are used).
  void check() const;
};

/// Point-to-plane ICP (Chen and Medioni 1992) of the model points that are seen against the scene: each with its
/// nearest scene point of similar normal. The correspondences of the hypothesis take part as pairs of points: they hold
/// the directions that the surface leaves free (along a face, about a can's axis), and many of them outweigh the noise
/// of the depth. Tukey weights by distance for both. `visible`: indices into model.points; scene side of the
/// correspondences in the world frame. Returns the pose unchanged without normals on both sides, with fewer than 20
/// pairs, or if it ran away.
[[nodiscard]] Rigid3 refine_pose_on_scene(const PreparedModel& model, const Rigid3& world_from_object,
                                          std::span<const int> visible, std::span<const Correspondence> correspondences,
                                          const PreparedScene& scene, const RefinePoseOptions& options = {});

/// How well the same pairs fix the pose, about the model's centre; not known where refine_pose_on_scene() would leave
/// the pose as it is for want of normals or pairs.
[[nodiscard]] PoseUncertainty estimate_pose_uncertainty(const PreparedModel& model, const Rigid3& world_from_object,
                                                        std::span<const int> visible,
                                                        std::span<const Correspondence> correspondences,
                                                        const PreparedScene& scene,
                                                        const RefinePoseOptions& options = {});

}  // namespace resight
