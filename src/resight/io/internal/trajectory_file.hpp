// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <filesystem>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "resight/core/result.hpp"
#include "resight/geometry/rigid3.hpp"

namespace resight::io {

/// Largest time between a colour image and its depth image (as in the tools of TUM).
inline constexpr double kMaxImageGap_s = 0.02;

/// A camera pose with its time, or with the name or number of its view.
struct StampedPose {
  double time_s = 0;  ///< NaN if the stamp is no number.
  std::string stamp;  ///< As in the file; empty if it has none.
  Rigid3 world_from_camera;
  double number = std::numeric_limits<double>::quiet_NaN();  ///< Of the view; NaN if the file does not number them.
};

/// Reads a file of camera poses: lines of 8 numbers (TUM: stamp tx ty tz qx qy qz qw; the stamp may be any word), of 9
/// numbers (phones: stamp number tx ..), of 12 or 16 numbers (KITTI: matrix row by row), or matrices of 4 rows, also
/// below a line of numbers (Open3D's .log); or JSON (json_poses.hpp). Numbers are separated by blanks or commas. A
/// first line without numbers is the title; it may name the seven numbers of a pose with a stamp in another order.
/// `world_from_camera` holds what the file says, whatever its convention; JSON defines it. In the order of the file.
/// Poses with stamps may be NaN (not tracked) if `may_be_untracked`; they are left out.
[[nodiscard]] Result<std::vector<StampedPose>> read_pose_list(const std::filesystem::path& file, bool may_be_untracked);

/// Interpolates the pose at a given time between its two neighbours in a list sorted by time. None if they are more
/// than 0.1 s away; at the ends the nearest pose within kMaxImageGap_s.
[[nodiscard]] std::optional<Rigid3> interpolate_pose(const std::vector<StampedPose>& poses, double time_s);

}  // namespace resight::io
