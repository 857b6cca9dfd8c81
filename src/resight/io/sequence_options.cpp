// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "resight/io/internal/files.hpp"
#include "resight/io/internal/listed_sequence.hpp"
#include "resight/io/internal/text.hpp"
#include "resight/io/internal/trajectory_file.hpp"
#include "resight/io/pose_text.hpp"

/// What the user says about a sequence of separate images.
namespace resight::io {
namespace {

constexpr double kMaxBaseline_m = 1;

bool gives_something(const OpenSequenceOptions& options) {
  return !options.intrinsics.empty() || !options.depth_intrinsics.empty() || !options.color_from_depth.empty() ||
         options.depth_scale_m || !options.poses.empty() || options.pose_convention != PoseConvention::kCameraToWorld ||
         options.views.every != 1 || options.views.min_motion_m > 0 || options.views.from_s || options.views.to_s;
}

Rigid3 to_world_from_camera(const Rigid3& pose, PoseConvention convention) {
  if (convention == PoseConvention::kWorldToCamera) return pose.inverse();
  if (convention == PoseConvention::kCameraToWorld) return pose;
  Eigen::Matrix3d flip = Eigen::Vector3d(1, -1, -1).asDiagonal();
  return pose * Rigid3::from_rotation(flip);
}

/// Without names and times of the views, whole stamps are numbers of views, as are those of a column of their own.
std::map<double, Rigid3> poses_by_number(const std::vector<StampedPose>& list) {
  std::map<double, Rigid3> by_number;
  const bool has_numbers = std::ranges::none_of(list, [](const StampedPose& p) { return std::isnan(p.number); });
  for (const StampedPose& pose : list) {
    const double number = has_numbers ? pose.number : pose.time_s;
    if (!std::isnan(number) && number != std::floor(number)) return {};
    by_number.emplace(number, pose.world_from_camera);
  }
  return by_number;
}

std::vector<std::optional<Rigid3>> in_order(const std::vector<StampedPose>& list) {
  std::vector<std::optional<Rigid3>> poses;
  for (const StampedPose& pose : list) poses.emplace_back(pose.world_from_camera);
  return poses;
}

/// Keeps the views that have a pose, and notes the number of the others.
Result<void> keep_posed_views(SequenceTable& table, const std::vector<std::optional<Rigid3>>& poses,
                              const fs::path& file) {
  std::vector<ListedView> kept;
  for (std::size_t i = 0; i < poses.size(); ++i)
    if (poses[i]) {
      kept.push_back(std::move(table.views[i]));
      kept.back().world_from_camera = *poses[i];
    }
  if (kept.empty()) return file_error(file, "holds no pose of any view (compared by name and by time)");
  if (kept.size() < poses.size())
    table.notes.push_back(fmt::format("{} of {} views have no pose in {} and are left out", poses.size() - kept.size(),
                                      poses.size(), file.filename().string()));
  table.views = std::move(kept);
  table.has_poses = true;
  return {};
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
  table.views = std::move(kept);
  return {};
}

Result<void> choose_views(SequenceTable& table, const ViewChoice& choice) {
  std::vector<ListedView> kept;
  const double begin_s = table.views.front().time_s;
  int number = 0;
  for (ListedView& view : table.views) {
    const double time_s = view.time_s - begin_s;
    if ((choice.from_s || choice.to_s) && std::isnan(time_s))
      return Error{"the views have no times, which --from and --until need; use --every"};
    if (choice.from_s && time_s < *choice.from_s) continue;
    if (choice.to_s && time_s > *choice.to_s) continue;
    if (number++ % choice.every == 0) kept.push_back(std::move(view));
  }
  if (kept.empty()) return Error{"no view lies between --from and --until"};
  table.views = std::move(kept);
  return choice.min_motion_m > 0 ? choose_moved_views(table, choice.min_motion_m) : Result<void>();
}

}  // namespace

Result<void> assign_poses(SequenceTable& table, const fs::path& file) {
  auto list = read_pose_list(file, true);
  if (!list) return list.error();
  std::vector<std::optional<Rigid3>> poses(table.views.size());
  if (list->empty()) return file_error(file, "holds no poses");
  const bool has_stamps = !list->front().stamp.empty();
  if (!has_stamps) {
    if (list->size() != poses.size())
      return file_error(file, fmt::format("holds {} poses without stamps for {} views", list->size(), poses.size()));
    return keep_posed_views(table, in_order(*list), file);
  }
  std::map<std::string, Rigid3, std::less<>> by_name;
  for (const StampedPose& pose : *list) by_name.emplace(pose.stamp, pose.world_from_camera);
  const std::map<double, Rigid3> by_number = poses_by_number(*list);
  const bool has_times = std::ranges::none_of(table.views, [](const ListedView& v) { return std::isnan(v.time_s); });
  const bool is_named = std::ranges::any_of(table.views, [&](const ListedView& v) { return by_name.contains(v.name); });
  if (!has_times && !is_named && by_number.empty()) {
    if (list->size() != poses.size())
      return file_error(file, fmt::format("holds {} poses with times, but the names of the {} images tell no times",
                                          list->size(), poses.size()));
    table.notes.push_back(
        fmt::format("the names of the images tell no times: the poses of {} are taken in the order of the views",
                    file.filename().string()));
    return keep_posed_views(table, in_order(*list), file);
  }
  std::ranges::stable_sort(*list, {}, &StampedPose::time_s);
  for (std::size_t i = 0; i < poses.size(); ++i) {
    const ListedView& view = table.views[i];
    const auto number = trailing_number(view.name);
    if (const auto it = by_name.find(view.name); it != by_name.end())
      poses[i] = it->second;
    else if (!std::isnan(view.time_s))
      poses[i] = interpolate_pose(*list, view.time_s);
    else if (const auto same = by_number.find(number.value_or(-1)); same != by_number.end())
      poses[i] = same->second;
  }
  return keep_posed_views(table, poses, file);
}

Result<void> set_depth_camera(SequenceTable& table, const OpenSequenceOptions& options) {
  if (options.depth_intrinsics.empty() && options.color_from_depth.empty()) return {};
  if (table.is_recording) return Error{"holds the depth camera itself: --depth-intrinsics does not apply"};
  if (options.depth_intrinsics.empty() || options.color_from_depth.empty())
    return Error{"--depth-intrinsics and --color-from-depth need each other"};
  const auto calibration = parse_calibration(options.depth_intrinsics);
  if (!calibration) return calibration.error();
  const auto color_from_depth = read_pose(options.color_from_depth);
  if (!color_from_depth) return color_from_depth.error();
  if (color_from_depth->translation.norm() > kMaxBaseline_m)
    return file_error(options.color_from_depth, fmt::format("its cameras are {:.3g} m apart (expected metres)",
                                                            color_from_depth->translation.norm()));
  table.depth_camera = DepthCamera{calibration->intrinsics, calibration->lens, *color_from_depth};
  return {};
}

Result<void> apply_options(Sequence& sequence, const OpenSequenceOptions& options) {
  if (!gives_something(options)) return {};
  if (SequenceTable* table = listed_table(sequence)) return apply_options(*table, options);
  return Error{
      "consists of PCD files, which hold camera, unit and poses themselves: --intrinsics, --depth-intrinsics, "
      "--depth-scale, --poses, --every, --min-motion, --from and --until do not apply"};
}

Result<void> apply_options(SequenceTable& table, const OpenSequenceOptions& options) {
  if (const auto done = set_depth_camera(table, options); !done) return done;
  if (!options.intrinsics.empty()) {
    const auto calibration = parse_calibration(options.intrinsics);
    if (!calibration) return calibration.error();
    table.lens = calibration->lens;
    for (ListedView& view : table.views) view.intrinsics = calibration->intrinsics;
  }
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
  // Transforms of a recording have one convention.
  if (options.poses != "fixed" && (!table.is_recording || !options.poses.empty()))
    for (ListedView& view : table.views)
      view.world_from_camera = to_world_from_camera(view.world_from_camera, options.pose_convention);
  return choose_views(table, options.views);
}

}  // namespace resight::io
