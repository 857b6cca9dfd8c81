// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <span>

#include "resight/geometry/rigid3.hpp"

namespace resight {

/// Absolute trajectory error after the best rigid motion of the whole trajectory (ATE; Sturm et al. 2012). Deviation:
/// the motion is fitted to rotations too, as points 1 m along the axes of each camera, so that few views suffice.
struct TrajectoryError {
  int num_views = 0;
  double rms_m = 0;
  double max_m = 0;
  double mean_rad = 0;  ///< Angle between the rotations.
  double max_rad = 0;
  Rigid3 reference_from_estimate;  ///< Rigid motion between the world frames.
};

/// Compares poses world_from_camera of the same views. Throws std::invalid_argument if the numbers of views differ.
[[nodiscard]] TrajectoryError find_trajectory_error(std::span<const Rigid3> reference,
                                                    std::span<const Rigid3> estimate);

}  // namespace resight
