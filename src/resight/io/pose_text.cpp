// SPDX-License-Identifier: Apache-2.0
#include "resight/io/pose_text.hpp"

#include <fmt/format.h>

#include <cmath>

#include "resight/geometry/limits.hpp"
#include "resight/io/internal/files.hpp"
#include "resight/io/internal/text.hpp"

namespace resight {
namespace {

bool is_far(const Eigen::Vector3d& translation) { return translation.cwiseAbs().maxCoeff() > kMaxSceneCoordinate_m; }

Error far_error(std::string_view what) {
  return Error{
      fmt::format("{}: the pose is more than {} m away from the origin (check its unit, or subtract an offset)", what,
                  kMaxSceneCoordinate_m)};
}

}  // namespace

Result<Rigid3> rigid_from_matrix(const Eigen::Matrix4d& matrix, std::string_view what) {
  const std::string name(what);
  if (!matrix.allFinite()) return Error{name + ": the pose holds NaN or infinite numbers"};
  if ((matrix.row(3) - Eigen::RowVector4d(0, 0, 0, 1)).cwiseAbs().maxCoeff() > kPoseTolerance)
    return Error{name + ": the last row of the pose is not 0 0 0 1"};
  Rigid3 pose = Rigid3::from_matrix(matrix);
  if (!pose.is_rigid(kPoseTolerance))
    return Error{
        name + ": the pose is not a rigid motion (scale, shear or reflection); expected a rotation and a translation"};
  if (is_far(pose.translation)) return far_error(what);
  if (!pose.is_rigid(1e-9)) pose.rotation = nearest_rotation(pose.rotation);
  return pose;
}

Result<Rigid3> rigid_from_numbers(std::span<const double> numbers, std::string_view what) {
  if (numbers.size() != 16 && numbers.size() != 12)
    return Error{fmt::format("{}: expected a pose of 12 or 16 numbers, found {}", what, numbers.size())};
  Eigen::Matrix4d matrix = Eigen::Matrix4d::Identity();
  for (std::size_t i = 0; i < numbers.size(); ++i)
    matrix(static_cast<int>(i / 4), static_cast<int>(i % 4)) = numbers[i];
  return rigid_from_matrix(matrix, what);
}

Result<Rigid3> rigid_from_quaternion(const Eigen::Quaterniond& rotation, const Eigen::Vector3d& translation,
                                     std::string_view what) {
  const double norm = rotation.norm();
  if (!translation.allFinite() || !(std::abs(norm - 1) <= kPoseTolerance))
    return Error{fmt::format("{}: the pose is not rigid (norm of the quaternion {}, expected 1; all numbers finite)",
                             what, norm)};
  if (is_far(translation)) return far_error(what);
  return Rigid3{rotation.normalized().toRotationMatrix(), translation};
}

Result<Rigid3> parse_pose(std::string_view text, std::string_view what) {
  auto numbers = io::parse_numbers(text);
  if (!numbers) {
    io::TextCursor cursor(text);
    cursor.next();
    numbers = io::parse_numbers(cursor.rest());
  }
  if (!numbers || (numbers->size() != 16 && numbers->size() != 12))
    return Error{std::string(what) + ": expected a pose of 16 numbers (a 4x4 matrix, row by row)" +
                 (numbers ? fmt::format(", found {}", numbers->size()) : "")};
  return rigid_from_numbers(*numbers, what);
}

Result<Rigid3> read_pose(const std::filesystem::path& file) {
  const auto text = io::read_file(file);
  if (!text) return text.error();
  return parse_pose(*text, file.string());
}

std::string format_pose(const Rigid3& pose) {
  const Eigen::Matrix4d m = pose.matrix();
  std::string text;
  for (int row = 0; row < 4; ++row)
    for (int col = 0; col < 4; ++col) text += fmt::format("{}{}", row + col > 0 ? " " : "", m(row, col));
  return text;
}

}  // namespace resight
