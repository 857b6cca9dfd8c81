// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "resight/io/internal/files.hpp"
#include "resight/io/internal/listed_sequence.hpp"
#include "resight/io/internal/sequences.hpp"
#include "resight/io/internal/text.hpp"
#include "resight/io/pose_text.hpp"

namespace resight::io {
namespace {

/// Largest time between a colour image and its depth image (as in the tools of the data set).
constexpr double kMaxImageGap_s = 0.02;
constexpr double kMaxPoseGap_s = 0.1;  ///< Largest time between an image and the poses before and after it.

struct StampedFile {
  double time_s = 0;
  fs::path file;
};
struct StampedPose {
  double time_s = 0;
  Rigid3 world_from_camera;
};

/// Calls row(words) for each line that is neither empty nor a comment, until it returns false.
template <typename Row>
Result<void> for_each_row(const fs::path& file, const Row& row) {
  const auto text = read_file(file);
  if (!text) return text.error();
  std::string_view rest = *text;
  for (int number = 1; !rest.empty(); ++number) {
    const auto words = split_tokens(cut_line(rest));
    if (words.empty() || words[0].starts_with('#')) continue;
    if (!row(words))
      return file_error(file, fmt::format("line {} cannot be parsed, or leads out of the folder", number));
  }
  return {};
}

Result<std::vector<StampedFile>> read_file_list(const fs::path& list) {
  std::vector<StampedFile> files;
  const auto done = for_each_row(list, [&](const std::vector<std::string_view>& words) {
    const auto time_s = parse_number(words[0]);
    if (!time_s || words.size() != 2) return false;
    const auto image = path_below(list.parent_path(), words[1]);
    if (!image) return false;
    files.push_back({*time_s, *image});
    return true;
  });
  if (!done) return done.error();
  std::ranges::stable_sort(files, {}, &StampedFile::time_s);
  return files;
}

using ImagePairs = std::vector<std::pair<StampedFile, StampedFile>>;  ///< Colour and depth.

Result<ImagePairs> read_associations(const fs::path& file) {
  ImagePairs pairs;
  const auto done = for_each_row(file, [&](const std::vector<std::string_view>& words) {
    if (words.size() != 4) return false;
    const auto first = parse_number(words[0]);
    const auto second = parse_number(words[2]);
    if (!first || !second) return false;
    const auto first_image = path_below(file.parent_path(), words[1]);
    const auto second_image = path_below(file.parent_path(), words[3]);
    if (!first_image || !second_image) return false;
    StampedFile color{*first, *first_image};
    StampedFile depth{*second, *second_image};
    if (words[1].starts_with("depth")) std::swap(color, depth);  // both orders occur
    pairs.emplace_back(std::move(color), std::move(depth));
    return true;
  });
  if (!done) return done.error();
  return pairs;
}

/// Pairs each colour image with the depth image nearest in time. A depth image belongs to the first colour image that
/// claims it.
Result<ImagePairs> associate(const fs::path& directory) {
  const auto colors = read_file_list(directory / "rgb.txt");
  if (!colors) return colors.error();
  const auto depths = read_file_list(directory / "depth.txt");
  if (!depths) return depths.error();
  ImagePairs pairs;
  std::size_t next = 0;
  for (const StampedFile& color : *colors) {
    const auto distance = [&](std::size_t i) { return std::abs((*depths)[i].time_s - color.time_s); };
    while (next + 1 < depths->size() && distance(next + 1) <= distance(next)) ++next;
    if (next < depths->size() && distance(next) <= kMaxImageGap_s) pairs.emplace_back(color, (*depths)[next++]);
  }
  return pairs;
}

Result<std::vector<StampedPose>> read_trajectory(const fs::path& file) {
  std::vector<StampedPose> poses;
  std::optional<Error> wrong_pose;
  const auto done = for_each_row(file, [&](const std::vector<std::string_view>& words) {
    std::vector<double> n;
    for (const std::string_view word : words)
      n.push_back(parse_number(word).value_or(std::numeric_limits<double>::quiet_NaN()));
    if (n.size() != 8) return false;
    const auto pose = rigid_from_quaternion({n[7], n[4], n[5], n[6]}, {n[1], n[2], n[3]},
                                            fmt::format("{}: time {}", file.string(), words[0]));
    if (!pose && !wrong_pose) wrong_pose = pose.error();
    if (pose && std::isfinite(n[0])) poses.push_back({n[0], *pose});
    return std::isfinite(n[0]);
  });
  if (!done) return done.error();
  if (wrong_pose) return *wrong_pose;
  std::ranges::stable_sort(poses, {}, &StampedPose::time_s);
  return poses;
}

/// Interpolates the pose at a given time between its two neighbours. None if they are too far away.
std::optional<Rigid3> interpolate(const std::vector<StampedPose>& poses, double time_s) {
  const auto after = std::ranges::lower_bound(poses, time_s, {}, &StampedPose::time_s);
  const bool has_after = after != poses.end() && after->time_s - time_s <= kMaxPoseGap_s;
  const bool has_before = after != poses.begin() && time_s - std::prev(after)->time_s <= kMaxPoseGap_s;
  if (has_after && has_before) {
    const StampedPose& a = *std::prev(after);
    const double t = after->time_s > a.time_s ? (time_s - a.time_s) / (after->time_s - a.time_s) : 0.0;
    const Eigen::Quaterniond q = Eigen::Quaterniond(a.world_from_camera.rotation)
                                     .slerp(t, Eigen::Quaterniond(after->world_from_camera.rotation));
    return Rigid3{q.normalized().toRotationMatrix(),
                  (1 - t) * a.world_from_camera.translation + t * after->world_from_camera.translation};
  }
  // At the ends of the recording, the nearest pose is used if it is close enough.
  if (has_after && after->time_s - time_s <= kMaxImageGap_s) return after->world_from_camera;
  if (has_before && time_s - std::prev(after)->time_s <= kMaxImageGap_s) return std::prev(after)->world_from_camera;
  return std::nullopt;
}

Result<Intrinsics> read_intrinsics(const fs::path& directory) {
  const fs::path file = directory / "camera.txt";
  if (is_file(file)) {
    const auto text = read_file(file);
    if (!text) return text.error();
    auto numbers = parse_numbers(*text);
    if (numbers && numbers->size() == 4)
      numbers = {(*numbers)[0], 0, (*numbers)[2], 0, (*numbers)[1], (*numbers)[3], 0, 0, 1};
    if (!numbers) return file_error(file, "expected 'fx fy cx cy' or a 3x3 camera matrix");
    return intrinsics_from_matrix(*numbers, file.string());
  }
  // Published calibrations of the data set, selected by the name of the recording.
  const std::string name = to_lower(folder_name(directory));
  if (name.find("freiburg2") != name.npos || name.find("fr2") != name.npos)
    return Intrinsics{520.9, 521.0, 325.1, 249.7};
  if (name.find("freiburg3") != name.npos || name.find("fr3") != name.npos)
    return Intrinsics{535.4, 539.2, 320.1, 247.6};
  return Intrinsics{517.3, 516.5, 318.6, 255.3};
}

}  // namespace

bool is_tum_sequence(const fs::path& directory) {
  return is_folder(directory / "rgb") && is_folder(directory / "depth") &&
         (is_file(directory / "associations.txt") ||
          (is_file(directory / "rgb.txt") && is_file(directory / "depth.txt")));
}

SequenceResult open_tum_sequence(const fs::path& directory) {
  const fs::path associations = directory / "associations.txt";
  const auto pairs = is_file(associations) ? read_associations(associations) : associate(directory);
  if (!pairs) return pairs.error();
  const auto intrinsics = read_intrinsics(directory);
  if (!intrinsics) return intrinsics.error();
  SequenceTable table;
  table.format = "tum";
  table.has_poses = is_file(directory / "groundtruth.txt");
  Result<std::vector<StampedPose>> poses = std::vector<StampedPose>{};
  if (table.has_poses) poses = read_trajectory(directory / "groundtruth.txt");
  if (!poses) return poses.error();
  for (const auto& [color, depth] : *pairs) {
    // Uses the pose of the depth image, because its geometry is placed in the world.
    const auto pose = table.has_poses ? interpolate(*poses, depth.time_s) : std::optional(Rigid3::identity());
    if (!pose) continue;
    ListedView view;
    view.name = color.file.stem().string();
    view.image_id = static_cast<int>(table.views.size());
    view.color = color.file;
    view.depth = depth.file;
    view.intrinsics = *intrinsics;
    view.metres_per_unit = 1.0 / 5000;
    view.world_from_camera = *pose;
    table.views.push_back(std::move(view));
  }
  if (table.views.empty())
    return file_error(directory, pairs->empty() ? "its lists name no pair of images"
                                                : "no image has a pose near in time in groundtruth.txt");
  return make_listed_sequence(std::move(table));
}

}  // namespace resight::io
