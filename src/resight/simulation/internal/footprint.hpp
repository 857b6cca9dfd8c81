// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>

#include "resight/geometry/triangle_mesh.hpp"

namespace resight {

/// A rectangle on a surface: what a thing covers, seen from above. Metres.
struct Footprint {
  Eigen::Vector2d center = Eigen::Vector2d::Zero();
  Eigen::Vector2d half_size = Eigen::Vector2d::Zero();  ///< Along its own axes.
  double yaw_rad = 0;                                   ///< Of its own x axis.

  /// Of the circle around it.
  [[nodiscard]] double radius_m() const { return half_size.norm(); }
};

/// The rectangle, along the mesh's own axes, that the mesh covers after it was turned by `roll_rad` about its x axis.
[[nodiscard]] Footprint footprint_of(const TriangleMesh& mesh, double roll_rad);

/// Whether two rectangles come nearer to each other than `gap_m` (separating axes; at their corners the distance that
/// is kept is up to 1.4 times as large).
[[nodiscard]] bool overlaps(const Footprint& a, const Footprint& b, double gap_m);

/// Whether all of the rectangle lies within |x| <= half_area.x, |y| <= half_area.y.
[[nodiscard]] bool lies_within(const Footprint& footprint, const Eigen::Vector2d& half_area);

}  // namespace resight
