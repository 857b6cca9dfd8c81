// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <span>
#include <vector>

namespace resight {

/// Indices of one point per occupied cube of side `spacing_m`: the point nearest to its centre (ties: the first). Cubes
/// are in order of their first points. All points must be finite.
[[nodiscard]] std::vector<int> sample_uniformly(std::span<const Eigen::Vector3f> points, double spacing_m);

}  // namespace resight
