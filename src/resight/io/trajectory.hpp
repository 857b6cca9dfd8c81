// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <filesystem>
#include <span>
#include <string>
#include <string_view>

#include "resight/core/result.hpp"
#include "resight/geometry/rigid3.hpp"

namespace resight {

/// A camera pose with its time or view.
struct TrajectoryPose {
  std::string stamp;  ///< Time in seconds, number or name of the view, as text.
  Rigid3 world_from_camera;
};

/// "tx ty tz qx qy qz qw" in metres, with all digits.
[[nodiscard]] std::string format_tum_pose(const Rigid3& pose);

/// The name of a view as one word of a line: blanks, control characters, commas, '#' and '%' become %20, %2C and so on.
[[nodiscard]] std::string to_pose_stamp(std::string_view name);

/// Writes a trajectory in the format of TUM: one line "stamp tx ty tz qx qy qz qw" per view in metres, after the lines
/// of `comment` (each prefixed by "# "), with to_pose_stamp() of its stamp. All digits are written, so that reading
/// gives the same pose.
[[nodiscard]] Result<void> write_tum_trajectory(const std::filesystem::path& file,
                                                std::span<const TrajectoryPose> poses, const std::string& comment);

}  // namespace resight
