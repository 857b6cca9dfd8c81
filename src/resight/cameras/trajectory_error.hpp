// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <span>

#include "resight/geometry/rigid3.hpp"

namespace resight {

/// How far one trajectory is from another after the best rigid motion of the whole (ATE; Sturm et al. 2012). Here the
/// rotations count in that motion too, as points 1 m before and beside each camera, so that it is defined for few
/// views.
struct TrajectoryError {
  int num_views = 0;
  double rms_m = 0;
  double max_m = 0;
  double mean_rad = 0;  ///< Angle between the rotations.
  double max_rad = 0;
  Rigid3 reference_from_estimate;  ///< Of the world frames.
};

/// Poses world_from_camera of the same views, as many in each.
[[nodiscard]] TrajectoryError find_trajectory_error(std::span<const Rigid3> reference,
                                                    std::span<const Rigid3> estimate);

}  // namespace resight
