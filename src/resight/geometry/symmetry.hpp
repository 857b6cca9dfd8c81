// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <span>
#include <vector>

#include "resight/geometry/rigid3.hpp"

namespace resight {

/// Symmetries of an object as in BOP's models_info.json, in metres: motions of the object frame that map the object
/// onto itself.
struct ObjectSymmetries {
  struct Continuous {
    Eigen::Vector3d axis = Eigen::Vector3d::UnitZ();
    Eigen::Vector3d offset = Eigen::Vector3d::Zero();  ///< A point on the axis.
  };
  std::vector<Rigid3> discrete;  ///< Without the identity.
  std::vector<Continuous> continuous;
  [[nodiscard]] bool none() const { return discrete.empty() && continuous.empty(); }
};

/// All symmetry motions, the identity first; continuous ones in steps of at most `max_step_rad`.
[[nodiscard]] std::vector<Rigid3> enumerate_symmetries(const ObjectSymmetries& symmetries,
                                                       double max_step_rad = 0.0872665);

/// The symmetry-equivalent of `pose` (a_from_object) that is nearest in rotation to `reference`; exact for a continuous
/// axis (the angle about it is solved for, not sampled), and for a ball (two axes that are not parallel: all rotations
/// about where they meet). Without symmetries: `pose` itself.
[[nodiscard]] Rigid3 nearest_symmetric_pose(const Rigid3& pose, const Rigid3& reference,
                                            const ObjectSymmetries& symmetries);

/// Smallest rotation angle between two poses of the object over its symmetries, radians.
[[nodiscard]] double symmetric_rotation_distance_rad(const Rigid3& a, const Rigid3& b,
                                                     const ObjectSymmetries& symmetries);

}  // namespace resight
