// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <vector>

#include "resight/geometry/rigid3.hpp"

namespace resight {

/// A rotation axis in the object frame.
struct RotationAxis {
  Eigen::Vector3d direction = Eigen::Vector3d::UnitZ();  ///< Of any length but 0.
  Eigen::Vector3d point = Eigen::Vector3d::Zero();       ///< A point on the axis, metres.
};

/// Rotation by `angle_rad` about the axis.
[[nodiscard]] Rigid3 rotation_about(const RotationAxis& axis, double angle_rad);

/// Symmetries of an object as in models_info.json of BOP: motions of the object frame, in metres, that map the object
/// onto itself.
struct ObjectSymmetries {
  std::vector<Rigid3> discrete;          ///< Excludes the identity.
  std::vector<RotationAxis> continuous;  ///< Rotations by any angle.
  [[nodiscard]] bool none() const { return discrete.empty() && continuous.empty(); }
};

/// Whether this can be a symmetry of an object whose coordinates are at most kMaxObjectCoordinate_m. False for NaN.
[[nodiscard]] bool is_possible_symmetry(const Rigid3& motion);
[[nodiscard]] bool is_possible_symmetry(const RotationAxis& axis);

/// 5 deg.
inline constexpr double kSymmetryStep_rad = 0.0872665;

/// All symmetry motions, starting with the identity. Continuous symmetries are sampled in steps of at most
/// `max_step_rad`.
[[nodiscard]] std::vector<Rigid3> enumerate_symmetries(const ObjectSymmetries& symmetries,
                                                       double max_step_rad = kSymmetryStep_rad);

/// Limit for the symmetry motions that a file declares. A ball with two axes has 5,184; each further axis multiplies
/// them by 72.
inline constexpr int kMaxSymmetryMotions = 20000;
/// Whether enumerate_symmetries() gives at most kMaxSymmetryMotions motions in steps of kSymmetryStep_rad.
[[nodiscard]] bool has_few_motions(const ObjectSymmetries& symmetries);

/// The pose equivalent to `pose` (a_from_object) under the symmetries that is nearest in rotation to `reference`.
/// Solves in closed form for the angle about a continuous axis, and for all rotations of a ball (two axes that are not
/// parallel, about their intersection). Returns `pose` if there are no symmetries.
[[nodiscard]] Rigid3 nearest_symmetric_pose(const Rigid3& pose, const Rigid3& reference,
                                            const ObjectSymmetries& symmetries);

/// Smallest rotation angle between two poses of the object under its symmetries, in radians.
[[nodiscard]] double symmetric_rotation_distance_rad(const Rigid3& a, const Rigid3& b,
                                                     const ObjectSymmetries& symmetries);

}  // namespace resight
