// SPDX-License-Identifier: Apache-2.0
#include "resight/io/internal/json_poses.hpp"

#include <fmt/format.h>

#include <limits>

#include "resight/io/internal/calibration_fields.hpp"
#include "resight/io/internal/json.hpp"
#include "resight/io/internal/listed_sequence.hpp"
#include "resight/io/pose_text.hpp"

namespace resight::io {
namespace {

constexpr double kNoTime = std::numeric_limits<double>::quiet_NaN();

Rigid3 look_forward(const Rigid3& pose) { return to_world_from_camera(pose, PoseConvention::kOpenGl); }

Result<Rigid3> pose_from_numbers(const std::vector<double>& numbers, std::string_view what) {
  const auto pose = rigid_from_numbers(numbers, what);
  if (!pose) return pose.error();
  return look_forward(*pose);
}

const nlohmann::json& first_of(const nlohmann::json& list) {
  static const nlohmann::json kNone;
  return list.is_array() && !list.empty() ? list.front() : kNone;
}

Result<std::vector<StampedPose>> poses_of_frames(const nlohmann::json& frames, const fs::path& file) {
  std::vector<StampedPose> poses;
  for (const nlohmann::json& frame : frames) {
    const std::string what = fmt::format("{}: frame {}", file.string(), poses.size());
    const auto numbers = as_numbers(member(frame, "transform_matrix"));
    const auto image = as_text(member(frame, "file_path"));
    if (!numbers || !image) return Error{what + ": expected a file_path and a transform_matrix of 16 numbers"};
    const auto pose = pose_from_numbers(*numbers, what);
    if (!pose) return pose.error();
    poses.push_back({kNoTime, *image, *pose});
  }
  return poses;
}

Result<std::vector<StampedPose>> poses_in_order(const nlohmann::json& list, const fs::path& file) {
  std::vector<StampedPose> poses;
  for (const nlohmann::json& entry : list) {
    const std::string what = fmt::format("{}: pose {}", file.string(), poses.size());
    const auto n = as_numbers(entry);
    if (!n || n->size() != 7) return Error{what + ": expected 7 numbers (qx qy qz qw tx ty tz)"};
    const auto pose = rigid_from_quaternion({(*n)[3], (*n)[0], (*n)[1], (*n)[2]}, {(*n)[4], (*n)[5], (*n)[6]}, what);
    if (!pose) return pose.error();
    poses.push_back({kNoTime, "", look_forward(*pose)});
  }
  return poses;
}

/// Row by row: t_00, t_01, .. t_23.
std::optional<std::vector<double>> named_elements(const nlohmann::json& json) {
  std::vector<double> numbers;
  for (int row = 0; row < 3; ++row)
    for (int col = 0; col < 4; ++col) {
      const auto number = as_number(member(json, fmt::format("t_{}{}", row, col)));
      if (!number) return std::nullopt;
      numbers.push_back(*number);
    }
  return numbers;
}

}  // namespace

bool holds_json_poses(const fs::path& file) {
  const auto json = read_json(file);
  if (!json) return false;
  return member(first_of(member(*json, "frames")), "transform_matrix").is_array() ||
         first_of(member(*json, "poses")).is_array();
}

Result<std::vector<StampedPose>> read_json_poses(const fs::path& file) {
  const auto json = read_json(file);
  if (!json) return json.error();
  if (const nlohmann::json& frames = member(*json, "frames"); frames.is_array()) return poses_of_frames(frames, file);
  if (const nlohmann::json& list = member(*json, "poses"); list.is_array()) return poses_in_order(list, file);
  return file_error(file, "holds no poses (expected \"frames\" with \"transform_matrix\", or \"poses\")");
}

Result<std::map<std::string, Calibration>> read_frame_calibrations(const fs::path& file) {
  std::map<std::string, Calibration> calibrations;
  const auto json = read_json(file);
  if (!json) return json.error();
  const nlohmann::json& frames = member(*json, "frames");
  if (!frames.is_array()) return calibrations;
  for (const nlohmann::json& frame : frames) {
    const auto image = as_text(member(frame, "file_path"));
    const auto calibration = calibration_from_json(frame, file.string());
    if (!calibration) return calibration.error();
    if (image && *calibration) calibrations.emplace(fs::path(*image).stem().string(), **calibration);
  }
  return calibrations;
}

Result<ViewCamera> read_view_camera(const fs::path& file) {
  const auto json = read_json(file);
  if (!json) return json.error();
  ViewCamera camera;
  const auto calibration = calibration_from_json(*json, file.string());
  if (!calibration) return calibration.error();
  camera.calibration = *calibration;
  auto numbers = named_elements(*json);
  if (!numbers) numbers = as_numbers(member(*json, "cameraPoseARFrame"));
  if (!numbers) return camera;
  const auto pose = pose_from_numbers(*numbers, file.string());
  if (!pose) return pose.error();
  camera.world_from_camera = *pose;
  return camera;
}

}  // namespace resight::io
