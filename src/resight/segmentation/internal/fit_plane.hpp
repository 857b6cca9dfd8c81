// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <span>

#include "resight/segmentation/scene_planes.hpp"

namespace resight {

/// Fits a plane to the given points by least squares. Its axes are in order of decreasing spread; its normal points to
/// the side of the point normals. It has no outline yet.
[[nodiscard]] ScenePlane fit_plane(std::span<const Eigen::Vector3f> points, std::span<const Eigen::Vector3f> normals,
                                   std::span<const int> indices);

/// Sets what bounds the plane: the cells that the given points cover, and its extent.
void set_outline(ScenePlane& plane, std::span<const Eigen::Vector3f> points, std::span<const int> indices);

}  // namespace resight
