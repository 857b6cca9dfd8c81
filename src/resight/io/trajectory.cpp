// SPDX-License-Identifier: Apache-2.0
#include "resight/io/trajectory.hpp"

#include <fmt/format.h>

#include <sstream>

#include "resight/core/files.hpp"

namespace resight {

Result<void> write_tum_trajectory(const std::filesystem::path& file, std::span<const TrajectoryPose> poses,
                                  const std::string& comment) {
  std::string text;
  std::istringstream lines(comment);
  for (std::string line; std::getline(lines, line);) text += "# " + line + "\n";
  text += "# stamp tx ty tz qx qy qz qw\n";
  for (const TrajectoryPose& pose : poses) {
    const Eigen::Vector3d& t = pose.world_from_camera.translation;
    const Eigen::Quaterniond q(pose.world_from_camera.rotation);
    text += fmt::format("{} {} {} {} {} {} {} {}\n", pose.stamp, t.x(), t.y(), t.z(), q.x(), q.y(), q.z(), q.w());
  }
  return write_file(file, text);
}

}  // namespace resight
