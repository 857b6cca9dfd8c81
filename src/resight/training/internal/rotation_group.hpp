// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <optional>
#include <span>
#include <vector>

namespace resight::internal {

/// Generates the finite group of rotations that are known only to a few degrees. Products within 12 deg of each other
/// count as one element. Each element is finally the mean of all products that give it, which makes the group exact to
/// double precision. The identity is first. Returns none if there are more than 60 elements (all larger finite groups
/// rotate about a single axis), or if the products are inconsistent.
[[nodiscard]] std::optional<std::vector<Eigen::Matrix3d>> generate_rotation_group(
    std::span<const Eigen::Matrix3d> generators);

}  // namespace resight::internal
