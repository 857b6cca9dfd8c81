// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <filesystem>
#include <span>
#include <string>
#include <string_view>

#include "resight/core/result.hpp"
#include "resight/geometry/rigid3.hpp"

namespace resight {

/// Tolerance for the deviation of a rotation or pose in a file from a rigid motion (matrix elements). Smaller
/// deviations come from few digits and are repaired; larger ones are errors.
inline constexpr double kPoseTolerance = 1e-2;

/// The rigid motion of a homogeneous matrix. Replaces the rotation by the nearest proper one if it deviates by more
/// than 1e-9. Fails (with `what` at the start of the message) for NaN, scale, shear, reflection, or a last row other
/// than 0 0 0 1.
[[nodiscard]] Result<Rigid3> rigid_from_matrix(const Eigen::Matrix4d& matrix, std::string_view what);

/// The rigid motion of a matrix of sixteen numbers in row-major order; with twelve, the last row is 0 0 0 1. Same
/// errors, and an error for another count.
[[nodiscard]] Result<Rigid3> rigid_from_numbers(std::span<const double> numbers, std::string_view what);

/// From a quaternion. Its norm may deviate from 1 by kPoseTolerance.
[[nodiscard]] Result<Rigid3> rigid_from_quaternion(const Eigen::Quaterniond& rotation,
                                                   const Eigen::Vector3d& translation, std::string_view what);

/// Parses sixteen numbers in row-major order (twelve: without the last row), separated by any white space. Skips one
/// word in front of them (a label in old files).
[[nodiscard]] Result<Rigid3> parse_pose(std::string_view text, std::string_view what);
/// Reads a file of that form.
[[nodiscard]] Result<Rigid3> read_pose(const std::filesystem::path& file);

/// Sixteen numbers in row-major order on one line, with all digits (read back bit for bit).
[[nodiscard]] std::string format_pose(const Rigid3& pose);

}  // namespace resight
