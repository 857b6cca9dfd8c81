// SPDX-License-Identifier: Apache-2.0
#include "resight/io/trajectory.hpp"

#include <fmt/format.h>

#include <sstream>

#include "resight/core/files.hpp"

namespace resight {

std::string format_tum_pose(const Rigid3& pose) {
  const Eigen::Vector3d& t = pose.translation;
  const Eigen::Quaterniond q(pose.rotation);
  return fmt::format("{} {} {} {} {} {} {}", t.x(), t.y(), t.z(), q.x(), q.y(), q.z(), q.w());
}

std::string to_pose_stamp(std::string_view name) {
  std::string stamp;
  for (const char c : name) {
    const auto byte = static_cast<unsigned char>(c);
    if (byte <= ' ' || byte == 0x7F || c == ',' || c == '#' || c == '%')
      stamp += fmt::format("%{:02X}", byte);
    else
      stamp += c;
  }
  return stamp;
}

Result<void> write_tum_trajectory(const std::filesystem::path& file, std::span<const TrajectoryPose> poses,
                                  const std::string& comment) {
  std::string text;
  std::istringstream lines(comment);
  for (std::string line; std::getline(lines, line);) text += "# " + line + "\n";
  text += "# stamp tx ty tz qx qy qz qw\n";
  for (const TrajectoryPose& pose : poses)
    text += fmt::format("{} {}\n", to_pose_stamp(pose.stamp), format_tum_pose(pose.world_from_camera));
  return write_file(file, text);
}

}  // namespace resight
