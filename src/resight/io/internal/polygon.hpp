// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <array>
#include <span>
#include <vector>

namespace resight::io {

/// Files whose faces have more corners are refused, because triangulate() takes time in the square of their number.
inline constexpr int kMaxPolygonCorners = 1024;

/// Cuts a polygon of at least three corners into triangles by clipping its ears; a convex polygon becomes the fan of
/// its first corner. Corners may be any numbers.
[[nodiscard]] std::vector<std::array<int, 3>> triangulate(std::span<const Eigen::Vector3f> polygon);

}  // namespace resight::io
