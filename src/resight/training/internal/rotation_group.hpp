// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <optional>
#include <span>
#include <vector>

namespace resight::internal {

/// The group that rotations generate which are known to a few degrees only: products within 12 deg of each other are
/// one element, and in the end each element is the mean of all products that give it, so that the group is one to
/// double precision. The identity first. None if there are more than 60 elements (no finite group that is not about a
/// single axis has more), or if the products do not fit together.
[[nodiscard]] std::optional<std::vector<Eigen::Matrix3d>> generate_rotation_group(
    std::span<const Eigen::Matrix3d> generators);

}  // namespace resight::internal
