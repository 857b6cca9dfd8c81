// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "resight/core/result.hpp"
#include "resight/io/internal/calibration.hpp"
#include "resight/io/internal/trajectory_file.hpp"

/// Cameras of views in JSON, as phones and reconstructions write them. In all these files, the camera looks along -z
/// and has y up; the poses that are returned look along z and have y down.
namespace resight::io {

/// A camera of one view. What the file does not say is missing.
struct ViewCamera {
  std::optional<Rigid3> world_from_camera;
  std::optional<Calibration> calibration;
};

/// Whether a file holds poses of many views: {"frames": [{"file_path": .., "transform_matrix": 4x4}, ..]} (nerfstudio,
/// Instant NGP) or {"poses": [[qx, qy, qz, qw, tx, ty, tz], ..]} (Record3D).
[[nodiscard]] bool holds_json_poses(const std::filesystem::path& file);
/// Reads these poses. Those of Record3D have no stamps.
[[nodiscard]] Result<std::vector<StampedPose>> read_json_poses(const std::filesystem::path& file);
/// The intrinsics that such a file gives for each view, by the name of its image without folder and extension.
[[nodiscard]] Result<std::map<std::string, Calibration>> read_frame_calibrations(const std::filesystem::path& file);

/// Reads the file of one view: Polycam (t_00 .. t_23, fx, fy, cx, cy) or 3D Scanner App (cameraPoseARFrame,
/// intrinsics).
[[nodiscard]] Result<ViewCamera> read_view_camera(const std::filesystem::path& file);

}  // namespace resight::io
