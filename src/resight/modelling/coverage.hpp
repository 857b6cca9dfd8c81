// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <span>
#include <vector>

#include "resight/geometry/rigid3.hpp"

namespace resight {

/// From where an object was looked at. Directions from its centre, object frame.
struct ViewCoverage {
  double share = 0;                                        ///< Of all directions that have a view within the angle.
  double share_above = 0;                                  ///< The same of those with z > 0,
  double share_below = 0;                                  ///< and of the others.
  Eigen::Vector3d largest_gap = Eigen::Vector3d::UnitZ();  ///< The direction that is farthest from any view,
  double largest_gap_rad = 0;                              ///< and how far.
};

/// `max_angle_rad`: features are found again up to about so far beside a view (paper: views every 15 deg).
[[nodiscard]] ViewCoverage measure_coverage(std::span<const Rigid3> object_from_camera, const Eigen::Vector3d& center,
                                            double max_angle_rad = 0.261799);

/// Views to train from: each the first whose direction differs by `min_angle_rad` or more from those of all chosen
/// before. Indices, ascending.
[[nodiscard]] std::vector<int> choose_key_views(std::span<const Rigid3> object_from_camera,
                                                const Eigen::Vector3d& center, double min_angle_rad = 0.261799);

}  // namespace resight
