// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <span>
#include <vector>

namespace resight {

/// Of the points in each cube of side `spacing_m` the one nearest to its centre (ties: the first): indices, in order of
/// the cubes' first points. All points must be finite.
[[nodiscard]] std::vector<int> sample_uniformly(std::span<const Eigen::Vector3f> points, double spacing_m);

}  // namespace resight
