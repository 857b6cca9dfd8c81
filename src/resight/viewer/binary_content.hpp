// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>

#include "resight/core/image.hpp"
#include "resight/geometry/point_cloud.hpp"

namespace resight {

// Binary contents for the browser, little-endian.

/// Depth in metres as float32, row by row; NaN means no return.
[[nodiscard]] std::string encode_depth(const Image<float>& depth_m);

/// A cloud: number of points and flags (1: normals, 2: colours) as uint32; then for all points x y z as float32; then,
/// if there are any, normals as int8 (127 is 1); then colours as uint8.
[[nodiscard]] std::string encode_cloud(const PointCloud& cloud);

}  // namespace resight
