// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <array>
#include <span>
#include <vector>

namespace resight::io {

/// Cuts a polygon of at least three corners into triangles by clipping its ears; a convex polygon becomes the fan of
/// its first corner. Takes time in the square of the number of corners. Corners may be any numbers.
[[nodiscard]] std::vector<std::array<int, 3>> triangulate(std::span<const Eigen::Vector3f> polygon);

}  // namespace resight::io
