// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <filesystem>
#include <string>
#include <string_view>

#include "resight/core/result.hpp"
#include "resight/geometry/rigid3.hpp"

namespace resight {

/// A rotation or pose of a file may deviate from a rigid motion by this much (matrix elements); more is an error, less
/// comes from few digits and is repaired.
inline constexpr double kPoseTolerance = 1e-2;

/// The rigid motion of a homogeneous matrix. Its rotation is replaced by the nearest proper one when it is off by more
/// than 1e-9. Error (starting with `what`) for NaN, scale, shear, reflection, or a last row other than 0 0 0 1.
[[nodiscard]] Result<Rigid3> rigid_from_matrix(const Eigen::Matrix4d& matrix, std::string_view what);

/// From a quaternion, of which the norm may be off by kPoseTolerance.
[[nodiscard]] Result<Rigid3> rigid_from_quaternion(const Eigen::Quaterniond& rotation,
                                                   const Eigen::Vector3d& translation, std::string_view what);

/// Sixteen numbers row by row (twelve: without the last row), in any white space; one word in front of them is skipped
/// (old files carry a label).
[[nodiscard]] Result<Rigid3> parse_pose(std::string_view text, std::string_view what);
[[nodiscard]] Result<Rigid3> read_pose(const std::filesystem::path& file);

/// Sixteen numbers row by row on one line, all digits (read back bit by bit).
[[nodiscard]] std::string format_pose(const Rigid3& pose);

}  // namespace resight
