// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <filesystem>
#include <span>
#include <string>

#include "resight/core/result.hpp"
#include "resight/geometry/rigid3.hpp"

namespace resight {

/// A camera pose with its time or view.
struct TrajectoryPose {
  std::string stamp;  ///< Time in seconds or number of the view, as text.
  Rigid3 world_from_camera;
};

/// "tx ty tz qx qy qz qw" in metres, with all digits.
[[nodiscard]] std::string format_tum_pose(const Rigid3& pose);

/// Writes a trajectory in the format of TUM: one line "stamp tx ty tz qx qy qz qw" per view in metres, after the lines
/// of `comment` (each prefixed by "# "). All digits are written, so that reading gives the same pose.
[[nodiscard]] Result<void> write_tum_trajectory(const std::filesystem::path& file,
                                                std::span<const TrajectoryPose> poses, const std::string& comment);

}  // namespace resight
