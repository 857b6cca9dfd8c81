// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <numbers>
#include <optional>
#include <span>

#include "resight/core/options.hpp"
#include "resight/geometry/rigid3.hpp"
#include "resight/registration/correspondence.hpp"
#include "resight/registration/pose_uncertainty.hpp"

namespace resight {

struct PreparedModel;
struct PreparedScene;

struct RefinePoseOptions {
  std::optional<int> max_iterations = 10;
  double max_distance_m = 0.015;
  double max_normal_angle_rad = 0.785398;
  double correspondence_weight = 4;
  std::optional<double> symmetry_step_rad{};
  void check() const { check_options("RefinePoseOptions", *this); }
};

inline void declare(OptionVisitor& v, RefinePoseOptions& o) {
  v.field(
      "max_iterations", o.max_iterations, at_least(1),
      "Iterations of point-to-plane ICP on a third of the points; up to six more on all. off: poses stay as they are.",
      "Chen and Medioni 1992");
  v.field("max_distance_m", o.max_distance_m, grid_length_m(),
          "Largest distance of a pair; weights fall to 0 there (Tukey).");
  v.field("max_normal_angle_rad", o.max_normal_angle_rad, between(0, std::numbers::pi / 2),
          "Largest angle between the normals of a pair (45 deg).");
  v.field(
      "correspondence_weight", o.correspondence_weight, at_least(0),
      "Weight of a pair of keypoints, relative to 1 for each surface point (at most 300). 0: keypoints take no part.");
  v.field(
      "symmetry_step_rad", o.symmetry_step_rad, between(1e-3, std::numbers::pi),
      "A refined pose is rotated by the symmetries of its shape (about the axis of a can in such steps; half turns of "
      "a box) to where the texture fits best; the shape search finds such objects by shape alone. off: it stays.");
}

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
