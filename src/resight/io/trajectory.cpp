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

Result<void> write_tum_trajectory(const std::filesystem::path& file, std::span<const TrajectoryPose> poses,
                                  const std::string& comment) {
  std::string text;
  std::istringstream lines(comment);
  for (std::string line; std::getline(lines, line);) text += "# " + line + "\n";
  text += "# stamp tx ty tz qx qy qz qw\n";
  for (const TrajectoryPose& pose : poses)
    text += fmt::format("{} {}\n", pose.stamp, format_tum_pose(pose.world_from_camera));
  return write_file(file, text);
}

}  // namespace resight
