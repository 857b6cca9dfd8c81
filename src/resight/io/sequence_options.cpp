// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "resight/io/internal/files.hpp"
#include "resight/io/internal/listed_sequence.hpp"
#include "resight/io/pose_text.hpp"

/// What the user says about a sequence of separate images.
namespace resight::io {
namespace {

constexpr double kMaxBaseline_m = 1;
constexpr double kTimeRounding_s = 1e-6;  ///< Times have microseconds, and as double little more.

bool gives_something(const OpenSequenceOptions& options) {
  return !options.intrinsics.empty() || !options.depth_intrinsics.empty() || !options.color_from_depth.empty() ||
         options.depth_scale_m || !options.poses.empty() || options.pose_convention != PoseConvention::kCameraToWorld ||
         options.views.every != 1 || options.views.min_motion_m != 0 || options.views.from_s || options.views.to_s ||
         options.views.max_views || options.topics != RecordingTopics{};
}

/// Of the camera, or of the point 1 m in front of it, whichever is larger.
double motion_m(const Rigid3& from, const Rigid3& to) {
  const Eigen::Vector3d ahead(0, 0, 1);
  return std::max((to.translation - from.translation).norm(), (to * ahead - from * ahead).norm());
}

Result<void> choose_moved_views(SequenceTable& table, double min_motion_m) {
  if (!table.has_poses) return Error{"the views have no poses, which --min-motion needs"};
  std::vector<ListedView> kept;
  for (ListedView& view : table.views)
    if (kept.empty() || motion_m(kept.back().world_from_camera, view.world_from_camera) >= min_motion_m)
      kept.push_back(std::move(view));
  table.notes.push_back(fmt::format("{} of {} views are used (--min-motion)", kept.size(), table.views.size()));
  table.views = std::move(kept);
  return {};
}

Result<void> choose_views(SequenceTable& table, const ViewChoice& choice) {
  if (choice.every < 1) return Error{"--every must be at least 1"};
  if (!(choice.min_motion_m >= 0)) return Error{"--min-motion must not be negative"};
  if (choice.max_views && *choice.max_views < 1) return Error{"--max-views must be at least 1"};
  std::vector<ListedView> kept;
  const double begin_s = table.views.front().time_s;
  int number = 0;
  for (ListedView& view : table.views) {
    const double time_s = view.time_s - begin_s;
    if ((choice.from_s || choice.to_s) && std::isnan(time_s))
      return Error{"the views have no times, which --from and --until need; use --every and --max-views"};
    if (choice.from_s && time_s < *choice.from_s - kTimeRounding_s) continue;
    if (choice.to_s && time_s > *choice.to_s + kTimeRounding_s) continue;
    if (number++ % choice.every == 0) kept.push_back(std::move(view));
  }
  if (kept.empty()) return Error{"no view lies between --from and --until"};
  table.views = std::move(kept);
  if (choice.min_motion_m > 0)
    if (const auto done = choose_moved_views(table, choice.min_motion_m); !done) return done;
  const auto max_views = static_cast<std::size_t>(choice.max_views.value_or(std::numeric_limits<int>::max()));
  if (table.views.size() > max_views) table.views.resize(max_views);
  return {};
}

/// The unit of depth remains that of the sequence.
Result<void> set_intrinsics(SequenceTable& table, const OpenSequenceOptions& options) {
  if (options.intrinsics.empty()) return {};
  const auto calibration = parse_calibration(options.intrinsics);
  if (!calibration) return calibration.error();
  table.lens = calibration->lens;
  for (ListedView& view : table.views) {
    view.intrinsics = calibration->intrinsics;
    view.own_camera.reset();
  }
  const ListedView& first = table.views.front();
  const auto unit_m = calibration->metres_per_unit;
  if (unit_m && !options.depth_scale_m && std::abs(*unit_m / first.metres_per_unit - 1) > 1e-6)
    table.notes.push_back(fmt::format("the unit of depth in {} ({:.6g} m) is not used (--depth-scale)",
                                      fs::path(options.intrinsics).filename().string(), *unit_m));
  if (table.is_recording) return {};  // Its images are checked when they are read.
  return check_image_size(*calibration, first.color, "--intrinsics");
}

}  // namespace

Rigid3 to_world_from_camera(const Rigid3& pose, PoseConvention convention) {
  if (convention == PoseConvention::kWorldToCamera) return pose.inverse();
  if (convention == PoseConvention::kCameraToWorld) return pose;
  Eigen::Matrix3d flip = Eigen::Vector3d(1, -1, -1).asDiagonal();
  return pose * Rigid3::from_rotation(flip);
}

Result<void> set_depth_camera(SequenceTable& table, const OpenSequenceOptions& options) {
  if (options.depth_intrinsics.empty() && options.color_from_depth.empty()) return {};
  if (table.is_recording) return Error{"holds the depth camera itself: --depth-intrinsics does not apply"};
  if (options.depth_intrinsics.empty() || options.color_from_depth.empty())
    return Error{"--depth-intrinsics and --color-from-depth need each other"};
  const auto calibration = parse_calibration(options.depth_intrinsics, "--depth-intrinsics");
  if (!calibration) return calibration.error();
  const auto color_from_depth = read_pose(options.color_from_depth);
  if (!color_from_depth) return color_from_depth.error();
  if (color_from_depth->translation.norm() > kMaxBaseline_m)
    return file_error(options.color_from_depth, fmt::format("its cameras are {:.3g} m apart (expected metres)",
                                                            color_from_depth->translation.norm()));
  table.depth_camera = DepthCamera{*calibration, *color_from_depth};
  return {};
}

Result<void> apply_options(Sequence& sequence, const OpenSequenceOptions& options) {
  if (!gives_something(options)) return {};
  if (SequenceTable* table = listed_table(sequence)) return apply_options(*table, options);
  return Error{
      "consists of PCD files, which hold camera, unit and poses themselves: --intrinsics, --depth-intrinsics, "
      "--depth-scale, --poses, --every, --min-motion, --from, --until, --max-views and the options of recordings do "
      "not "
      "apply"};
}

Result<void> apply_options(SequenceTable& table, const OpenSequenceOptions& options) {
  if (!table.is_recording && options.topics != RecordingTopics{})
    return Error{
        "is no recording: --color-topic, --depth-topic, --camera-info, --world-frame, --camera-frame and "
        "--max-time-difference-ms do not apply"};
  if (const auto done = set_depth_camera(table, options); !done) return done;
  if (const auto done = set_intrinsics(table, options); !done) return done;
  if (options.depth_scale_m) {
    table.npy_unit_m = options.depth_scale_m;
    for (ListedView& view : table.views) view.metres_per_unit = *options.depth_scale_m;
  }
  if (options.poses == "fixed") {
    table.has_poses = true;
    for (ListedView& view : table.views) view.world_from_camera = Rigid3::identity();
  } else if (!options.poses.empty()) {
    if (const auto done = assign_poses(table, options.poses); !done) return done;
  }
  if (table.poses_tell_convention && options.pose_convention == PoseConvention::kWorldToCamera)
    return Error{"--pose-convention world-to-camera does not apply: JSON files of poses have camera to world"};
  // Transforms of a recording have one convention.
  if (!table.poses_tell_convention && options.poses != "fixed" && (!table.is_recording || !options.poses.empty()))
    for (ListedView& view : table.views)
      view.world_from_camera = to_world_from_camera(view.world_from_camera, options.pose_convention);
  return choose_views(table, options.views);
}

}  // namespace resight::io
