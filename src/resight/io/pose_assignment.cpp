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
#include "resight/io/trajectory.hpp"

/// Which pose of a file belongs to which view.
namespace resight::io {
namespace {

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

/// `kind`: what the poses are, for the error if there is not one for each view.
Result<void> assign_in_order(SequenceTable& table, const std::vector<StampedPose>& list, const fs::path& file,
                             std::string_view kind) {
  if (list.size() != table.views.size())
    return file_error(file, fmt::format("holds {} poses {} for {} views", list.size(), kind, table.views.size()));
  std::vector<std::optional<Rigid3>> poses;
  for (const StampedPose& pose : list) poses.emplace_back(pose.world_from_camera);
  return keep_posed_views(table, poses, file);
}

/// Poses with stamps, by what may tell their view.
class StampedPoses {
 public:
  explicit StampedPoses(std::vector<StampedPose> list) : num_poses_(list.size()), by_time_(std::move(list)) {
    for (const StampedPose& pose : by_time_) {
      by_name_.emplace(pose.stamp, pose.world_from_camera);
      if (std::isnan(pose.time_s)) by_name_.emplace(fs::path(pose.stamp).stem().string(), pose.world_from_camera);
    }
    number_poses();
    std::erase_if(by_time_, [](const StampedPose& pose) { return std::isnan(pose.time_s); });
    std::ranges::stable_sort(by_time_, {}, &StampedPose::time_s);
  }

  [[nodiscard]] bool has_name(const ListedView& view) const { return find_name(view) != by_name_.end(); }
  [[nodiscard]] bool has_numbers() const { return !by_number_.empty(); }
  /// In the order of time, if each has another one; otherwise empty.
  [[nodiscard]] std::vector<StampedPose> by_time() const {
    const auto same = [](const StampedPose& a, const StampedPose& b) { return a.time_s == b.time_s; };
    const bool is_order = by_time_.size() == num_poses_ && std::ranges::adjacent_find(by_time_, same) == by_time_.end();
    return is_order ? by_time_ : std::vector<StampedPose>();
  }

  [[nodiscard]] std::optional<Rigid3> find(const ListedView& view) const {
    if (const auto it = find_name(view); it != by_name_.end()) return it->second;
    if (!std::isnan(view.time_s)) return interpolate_pose(by_time_, view.time_s);
    const auto number = trailing_number(view.name);
    const auto it = number ? by_number_.find(static_cast<double>(*number)) : by_number_.end();
    return it == by_number_.end() ? std::nullopt : std::optional(it->second);
  }

 private:
  using PosesByName = std::map<std::string, Rigid3, std::less<>>;

  /// As it is, or as `resight track` writes it.
  [[nodiscard]] PosesByName::const_iterator find_name(const ListedView& view) const {
    const auto it = by_name_.find(view.name);
    return it != by_name_.end() ? it : by_name_.find(to_pose_stamp(view.name));
  }

  /// Numbers of views have a column of their own, are at the end of words ("rgb/frame-000003.png"), or are whole
  /// stamps. If one is not whole, they are times.
  void number_poses() {
    const bool has_column = std::ranges::any_of(by_time_, [](const StampedPose& p) { return !std::isnan(p.number); });
    for (const StampedPose& pose : by_time_) {
      double number = has_column ? pose.number : pose.time_s;
      if (const auto end = trailing_number(fs::path(pose.stamp).stem().string()); std::isnan(pose.time_s) && end)
        number = *end;
      if (std::isnan(number)) continue;
      if (number != std::floor(number)) return by_number_.clear();
      by_number_.emplace(number, pose.world_from_camera);
    }
  }

  std::size_t num_poses_;
  std::vector<StampedPose> by_time_;
  PosesByName by_name_;
  std::map<double, Rigid3> by_number_;
};

}  // namespace

Result<void> assign_poses(SequenceTable& table, const fs::path& file) {
  table.poses_tell_convention = extension_of(file) == "json";
  const auto list = read_pose_list(file, true);
  if (!list) return list.error();
  if (list->empty()) return file_error(file, "holds no poses");
  if (list->front().stamp.empty()) return assign_in_order(table, *list, file, "without stamps");
  const StampedPoses stamped(*list);
  const bool tells_view = stamped.has_numbers() || std::ranges::any_of(table.views, [&](const ListedView& view) {
                            return !std::isnan(view.time_s) || stamped.has_name(view);
                          });
  if (!tells_view) {
    const std::vector<StampedPose> by_time = stamped.by_time();
    if (by_time.empty())
      return file_error(file, "holds no pose of any view: its stamps are no names, numbers or times");
    table.notes.push_back(
        fmt::format("the names of the images tell no times: the poses of {} are taken in the order of the views",
                    file.filename().string()));
    return assign_in_order(table, by_time, file, "with times, which the names of the images do not tell,");
  }
  std::vector<std::optional<Rigid3>> poses;
  for (const ListedView& view : table.views) poses.push_back(stamped.find(view));
  return keep_posed_views(table, poses, file);
}

}  // namespace resight::io
