// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>

#include "resight/geometry/triangle_mesh.hpp"

namespace resight {

/// The rectangle that an object covers on a surface, in metres.
struct Footprint {
  Eigen::Vector2d center = Eigen::Vector2d::Zero();
  Eigen::Vector2d half_size = Eigen::Vector2d::Zero();  ///< Along the axes of the rectangle.
  double yaw_rad = 0;                                   ///< Of the x axis of the rectangle.

  /// Radius of the circumscribed circle.
  [[nodiscard]] double radius_m() const { return half_size.norm(); }
};

/// The rectangle, parallel to the mesh axes, that the mesh covers after a rotation by `roll_rad` about its x axis.
[[nodiscard]] Footprint footprint_of(const TriangleMesh& mesh, double roll_rad);

/// Whether two rectangles are closer than `gap_m` (separating axes; at corners, the required distance is up to 1.4
/// times as large).
[[nodiscard]] bool overlaps(const Footprint& a, const Footprint& b, double gap_m);

/// Whether the whole rectangle lies within |x| <= half_area.x, |y| <= half_area.y.
[[nodiscard]] bool lies_within(const Footprint& footprint, const Eigen::Vector2d& half_area);

}  // namespace resight
