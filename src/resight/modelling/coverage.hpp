// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <span>
#include <vector>

#include "resight/geometry/rigid3.hpp"

namespace resight {

/// Directions from which an object was observed, seen from its centre. Object frame.
struct ViewCoverage {
  double share = 0;  ///< Share of all directions with a view within the angle.
  /// Share of the directions with z > 0 that have a view within the angle.
  double share_above = 0;
  /// Share of the directions with z <= 0 that have a view within the angle.
  double share_below = 0;
  Eigen::Vector3d largest_gap = Eigen::Vector3d::UnitZ();  ///< Direction farthest from any view.
  /// Angle between largest_gap and the nearest view.
  double largest_gap_rad = 0;
};

/// Measures the coverage by the views. `max_angle_rad`: largest angle to a view at which its features are still matched
/// (paper: views every 15 deg). `center` is in the object frame.
[[nodiscard]] ViewCoverage measure_coverage(std::span<const Rigid3> object_from_camera, const Eigen::Vector3d& center,
                                            double max_angle_rad = 0.261799);

/// Selects training views in order: a view is chosen if its direction differs by at least `min_angle_rad` from all
/// chosen before. Ascending indices.
[[nodiscard]] std::vector<int> choose_key_views(std::span<const Rigid3> object_from_camera,
                                                const Eigen::Vector3d& center, double min_angle_rad = 0.261799);

}  // namespace resight
