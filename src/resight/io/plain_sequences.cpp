// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "resight/core/names.hpp"
#include "resight/io/internal/files.hpp"
#include "resight/io/internal/json.hpp"
#include "resight/io/internal/listed_sequence.hpp"
#include "resight/io/internal/sequences.hpp"
#include "resight/io/internal/text.hpp"
#include "resight/io/pose_text.hpp"

/// Readers for layouts of some small public data sets: colour and depth images beside each other, with a text file
/// about the camera.
namespace resight::io {
namespace {

constexpr double kTenthMillimetre_m = 1e-4;

/// Stems of the files `<stem><suffix>` in a directory, in natural order.
std::vector<std::string> list_stems(const fs::path& directory, std::string_view suffix) {
  std::vector<std::string> stems;
  for (const std::string& name : list_files(directory))
    if (name.ends_with(suffix) && name.size() > suffix.size())
      stems.push_back(name.substr(0, name.size() - suffix.size()));
  return stems;
}

Result<Intrinsics> read_camera_matrix(const fs::path& file) {
  const auto text = read_file(file);
  if (!text) return text.error();
  const auto numbers = parse_numbers(*text);
  return intrinsics_from_matrix(numbers ? *numbers : std::vector<double>{}, file.string());
}

Error no_views(const fs::path& directory, std::string_view expected) {
  return file_error(directory, fmt::format("holds no views (expected {})", expected));
}

ListedView make_view(const fs::path& directory, const std::string& stem, std::string_view color, std::string_view depth,
                     int image_id) {
  ListedView view;
  view.name = stem;
  view.image_id = image_id;
  view.color = directory / (stem + std::string(color));
  view.depth = directory / (stem + std::string(depth));
  return view;
}

/// Parses "INTRINSICS: [618.0, 0.0, ...]"; the list may extend over several lines.
Result<Intrinsics> read_meta_yml(const fs::path& file) {
  const auto text = read_file(file);
  if (!text) return text.error();
  const std::size_t key = text->find("INTRINSICS:");
  const std::size_t open = text->find('[', key == text->npos ? text->size() : key);
  const std::size_t close = text->find(']', open == text->npos ? text->size() : open);
  if (close == text->npos) return file_error(file, "expected INTRINSICS: [9 numbers]");
  std::string list = text->substr(open + 1, close - open - 1);
  std::ranges::replace(list, ',', ' ');
  const auto numbers = parse_numbers(list);
  return intrinsics_from_matrix(numbers ? *numbers : std::vector<double>{}, file.string());
}

Result<Rigid3> parse_matrix(const nlohmann::json& json, std::string_view what) {
  const auto numbers = as_numbers(json);
  if (!numbers || numbers->size() != 16) return Error{fmt::format("{}: expected a 4x4 matrix", what)};
  return rigid_from_numbers(*numbers, what);
}

/// Reads derived/pseudo_gt.json {"frames": {"<view>": [{"object": .., "camera_from_object": 4x4}]}}.
Result<void> add_truth_per_view(const fs::path& file, SequenceTable& table) {
  if (!is_file(file)) return {};
  const auto json = read_json(file);
  if (!json) return json.error();
  const nlohmann::json& frames = member(*json, "frames");
  if (!frames.is_object()) return file_error(file, "expected an object 'frames'");
  table.has_ground_truth = true;
  for (ListedView& view : table.views) {
    std::map<std::string, int> counts;
    for (const auto& entry : member(frames, view.name)) {
      const std::string what = fmt::format("{}: view {}", file.string(), view.name);
      const auto name = as_text(member(entry, "object"));
      const auto pose = parse_matrix(member(entry, "camera_from_object"), what);
      if (!name) return Error{what + ": an object has no name"};
      if (const auto checked = check_object_name(*name); !checked)
        return Error{fmt::format("{}: {}", what, checked.error().message)};
      if (!pose) return pose.error();
      view.ground_truth.push_back({*name, 0, counts[*name]++, *pose, std::numeric_limits<double>::quiet_NaN()});
    }
  }
  return {};
}

/// Reads derived/pseudo_gt.json {"<object>": {"T_world_model": 4x4}} of a static scene.
Result<void> add_truth_in_world(const fs::path& file, SequenceTable& table) {
  if (!is_file(file)) return {};
  const auto json = read_json(file);
  if (!json) return json.error();
  if (!json->is_object()) return file_error(file, "expected an object");
  for (const auto& [name, entry] : json->items()) {
    if (member(entry, "T_world_model").is_null()) continue;
    if (const auto checked = check_object_name(name); !checked) return file_error(file, checked.error().message);
    const auto world_from_object =
        parse_matrix(member(entry, "T_world_model"), fmt::format("{}: {}", file.string(), name));
    if (!world_from_object) return world_from_object.error();
    table.has_ground_truth = true;
    for (ListedView& view : table.views)
      view.ground_truth.push_back({name, 0, 0, view.world_from_camera.inverse() * *world_from_object,
                                   std::numeric_limits<double>::quiet_NaN()});
  }
  return {};
}

/// Blocks of numbers, each below a comment line with its title.
struct CameraInfo {
  Intrinsics color;
  std::vector<Rigid3> world_from_camera;
};

Result<CameraInfo> read_camera_info(const fs::path& file) {
  const auto text = read_file(file);
  if (!text) return text.error();
  CameraInfo info;
  std::string_view rest = *text;
  std::string title;
  std::string block;
  const auto end_block = [&]() -> Result<void> {
    if (title.find("Color camera intrinsic") != title.npos) {
      const auto k =
          intrinsics_from_matrix(parse_numbers(block).value_or(std::vector<double>{}), file.string() + ": " + title);
      if (!k) return k.error();
      info.color = *k;
    } else if (title.find("Camera-to-world extrinsic") != title.npos) {
      const auto pose = parse_pose(block, file.string() + ": " + title);
      if (!pose) return pose.error();
      info.world_from_camera.push_back(*pose);
    }
    block.clear();
    return {};
  };
  while (!rest.empty()) {
    const std::string_view line = cut_line(rest);
    if (line.starts_with('#')) {
      if (const auto done = end_block(); !done) return done.error();
      title = line.substr(1);
    } else {
      block += std::string(line) + "\n";
    }
  }
  if (const auto done = end_block(); !done) return done.error();
  if (!(info.color.fx > 0)) return file_error(file, "holds no 'Color camera intrinsic matrix'");
  return info;
}

constexpr const char* kAssumesStaticCamera = "no file of poses: the camera is taken to stand still (--poses)";

}  // namespace

bool is_npy_sequence(const fs::path& directory) {
  return is_file(directory / "cam_K.txt") && is_folder(directory / "rgb") &&
         !list_stems(directory / "depth", ".npy").empty() && !holds_poses(directory);
}

SequenceResult open_npy_sequence(const fs::path& directory, const OpenSequenceOptions& options) {
  const auto intrinsics = read_camera_matrix(directory / "cam_K.txt");
  if (!intrinsics) return intrinsics.error();
  SequenceTable table;
  table.format = "npy";
  if (options.poses.empty()) table.notes.emplace_back(kAssumesStaticCamera);
  table.depth_storage = DepthStorage::kByName;
  for (const std::string& stem : list_stems(directory / "rgb", ".png")) {
    ListedView view = make_view(directory / "rgb", stem, ".png", "", static_cast<int>(table.views.size()));
    view.depth = directory / "depth" / (stem + ".npy");
    view.intrinsics = *intrinsics;
    table.views.push_back(std::move(view));
  }
  if (table.views.empty()) return no_views(directory, "rgb/<view>.png and depth/<view>.npy");
  return make_listed_sequence(std::move(table));
}

bool is_fixed_camera_sequence(const fs::path& directory) {
  return is_file(directory / "meta.yml") && !list_stems(directory, "-color.png").empty();
}

SequenceResult open_fixed_camera_sequence(const fs::path& directory, const OpenSequenceOptions& options) {
  const auto intrinsics = read_meta_yml(directory / "meta.yml");
  if (!intrinsics) return intrinsics.error();
  SequenceTable table;
  table.format = "color-depth";
  if (options.poses.empty()) table.notes.emplace_back(kAssumesStaticCamera);
  for (const std::string& stem : list_stems(directory, "-color.png")) {
    table.views.push_back(make_view(directory, stem, "-color.png", "-depth.png", static_cast<int>(table.views.size())));
    table.views.back().intrinsics = *intrinsics;
  }
  if (const auto done = add_truth_per_view(directory / "derived" / "pseudo_gt.json", table); !done) return done.error();
  return make_listed_sequence(std::move(table));
}

bool is_camera_info_sequence(const fs::path& directory) {
  return is_file(directory / "cam.info.txt") && !list_stems(directory, ".color.png").empty();
}

SequenceResult open_camera_info_sequence(const fs::path& directory) {
  const auto info = read_camera_info(directory / "cam.info.txt");
  if (!info) return info.error();
  SequenceTable table;
  table.format = "cam-info";
  table.depth_storage = DepthStorage::kRotatedPng;
  const auto stems = list_stems(directory, ".color.png");
  if (stems.size() != info->world_from_camera.size())
    return file_error(directory / "cam.info.txt",
                      fmt::format("holds {} camera poses for {} views", info->world_from_camera.size(), stems.size()));
  for (std::size_t i = 0; i < stems.size(); ++i) {
    ListedView view = make_view(directory, stems[i], ".color.png", ".depth.png", static_cast<int>(i));
    view.intrinsics = info->color;
    view.metres_per_unit = kTenthMillimetre_m;
    view.world_from_camera = info->world_from_camera[i];
    table.views.push_back(std::move(view));
  }
  for (const fs::path& base : {directory, fs::absolute(directory).lexically_normal() / ".."})
    if (!table.has_ground_truth)
      if (const auto done = add_truth_in_world(base / "derived" / "pseudo_gt.json", table); !done) return done.error();
  return make_listed_sequence(std::move(table));
}

bool is_numbered_cameras_sequence(const fs::path& directory) {
  return is_file(directory / "camera-0.intrinsics.txt") && !list_stems(directory, "-0.color.png").empty();
}

SequenceResult open_numbered_cameras_sequence(const fs::path& directory) {
  SequenceTable table;
  table.format = "numbered-cameras";
  for (const std::string& stem : list_stems(directory, ".color.png")) {
    const auto number = trailing_number(stem);
    if (!number) continue;  // other images in the folder
    const std::string camera = fmt::format("camera-{}", *number);
    const auto intrinsics = read_camera_matrix(directory / (camera + ".intrinsics.txt"));
    if (!intrinsics) return intrinsics.error();
    const auto pose = read_pose(directory / (camera + ".pose.txt"));
    if (!pose) return pose.error();
    ListedView view = make_view(directory, stem, ".color.png", ".depth.png", static_cast<int>(table.views.size()));
    view.intrinsics = *intrinsics;
    view.metres_per_unit = kTenthMillimetre_m;
    view.world_from_camera = *pose;
    table.views.push_back(std::move(view));
  }
  return make_listed_sequence(std::move(table));
}

}  // namespace resight::io
