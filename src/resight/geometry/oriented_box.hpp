// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "resight/geometry/point_cloud.hpp"

namespace resight {

/// A box around points, along their principal axes. Its x axis is the longest side, its z axis the shortest.
struct OrientedBox {
  Rigid3 world_from_box;                             ///< The origin is the centre of the box.
  Eigen::Vector3d size_m = Eigen::Vector3d::Zero();  ///< Length of the sides.
};

/// The smallest box with the axes of a principal component analysis that holds the points, without the few that lie far
/// beyond the others. Throws std::invalid_argument for an empty cloud.
[[nodiscard]] OrientedBox fit_box(const PointCloud& cloud_in_world);

}  // namespace resight
