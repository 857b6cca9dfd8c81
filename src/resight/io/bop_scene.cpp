// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <set>

#include "resight/core/names.hpp"
#include "resight/io/internal/bop_dataset.hpp"
#include "resight/io/internal/json.hpp"
#include "resight/io/internal/sequences.hpp"
#include "resight/io/internal/text.hpp"

namespace resight::io {
namespace {

using Names = std::map<int, BopModelInfo>;

constexpr double kMinDepthScale = 1e-6;
constexpr double kMaxDepthScale = 1e6;

/// Finds the image of a view in one of several folders, with one of several extensions.
std::optional<fs::path> find_image(const fs::path& scene, std::initializer_list<const char*> folders, int image_id) {
  for (const char* folder : folders)
    for (const char* extension : {".png", ".jpg", ".jpeg"}) {
      fs::path file = scene / folder / (bop_number(image_id) + extension);
      if (is_file(file)) return file;
    }
  return std::nullopt;
}

Result<ListedView> parse_camera(const fs::path& scene, int image_id, const nlohmann::json& entry, bool& has_pose) {
  const std::string what = fmt::format("{}: image {}", (scene / "scene_camera.json").string(), image_id);
  ListedView view;
  view.image_id = image_id;
  view.name = bop_number(image_id);
  const auto color = find_image(scene, {"rgb", "gray"}, image_id);
  const auto depth = find_image(scene, {"depth"}, image_id);
  if (!color)
    return Error{fmt::format("{}: its colour image is missing (rgb/{}.png or .jpg, or in gray/)", what, view.name)};
  if (!depth) return Error{fmt::format("{}: its depth image is missing (depth/{}.png)", what, view.name)};
  view.color = *color;
  view.depth = *depth;
  const auto intrinsics =
      intrinsics_from_matrix(as_numbers(member(entry, "cam_K")).value_or(std::vector<double>{}), what + ": cam_K");
  if (!intrinsics) return intrinsics.error();
  view.intrinsics = *intrinsics;
  const double depth_scale =
      member(entry, "depth_scale").is_null() ? 1.0 : as_number(member(entry, "depth_scale")).value_or(0);
  if (!(depth_scale >= kMinDepthScale && depth_scale <= kMaxDepthScale))
    return Error{what + ": depth_scale must be a number from 1e-6 to 1e6 (millimetres per unit)"};
  view.metres_per_unit = depth_scale * 1e-3;
  const nlohmann::json& rotation = member(entry, "cam_R_w2c");
  has_pose = !rotation.is_null();
  if (has_pose) {
    const auto camera_from_world =
        rigid_from_bop(rotation, member(entry, "cam_t_w2c"), what + ": cam_R_w2c, cam_t_w2c");
    if (!camera_from_world) return camera_from_world.error();
    view.world_from_camera = camera_from_world->inverse();
  }
  return view;
}

/// Notes depth images that scene_camera.json does not name: their views are left out.
void note_unnamed_images(const fs::path& scene, SequenceTable& table) {
  std::set<std::string> named;
  for (const ListedView& view : table.views) named.insert(view.depth.filename().string());
  std::vector<std::string> unnamed;
  for (const std::string& name : list_files(scene / "depth")) {
    const auto number = parse_integer(fs::path(name).stem().string());
    if (number && *number >= 0 && extension_of(name) == "png" && !named.contains(name)) unnamed.push_back(name);
  }
  if (unnamed.empty()) return;
  table.notes.push_back(fmt::format("{} depth images, such as {}, are not in scene_camera.json and are left out",
                                    unnamed.size(), unnamed.front()));
}

/// Visible share of the silhouette; NaN if the file does not state it, or states -1.
double visible_share(const nlohmann::json& info, int image_id, std::size_t index) {
  const nlohmann::json& list = member(info, std::to_string(image_id));
  if (!list.is_array() || index >= list.size()) return std::numeric_limits<double>::quiet_NaN();
  const auto share = as_number(member(list[index], "visib_fract"));
  return share && *share >= 0 && *share <= 1 + 1e-6 ? std::min(*share, 1.0) : std::numeric_limits<double>::quiet_NaN();
}

Result<GroundTruthObject> parse_object(const nlohmann::json& entry, const Names& names,
                                       std::map<std::string, int>& counts, std::string_view what) {
  const auto id = as_integer(member(entry, "obj_id"));
  if (!id || *id < 0) return Error{fmt::format("{}: obj_id must be a whole number", what)};
  const auto pose = rigid_from_bop(member(entry, "cam_R_m2c"), member(entry, "cam_t_m2c"),
                                   fmt::format("{}: cam_R_m2c, cam_t_m2c", what));
  if (!pose) return pose.error();
  GroundTruthObject object;
  const auto known = names.find(*id);
  object.object =
      known != names.end() ? known->second.name : as_text(member(entry, "name")).value_or(bop_object_name(*id));
  if (const auto checked = check_object_name(object.object); !checked)
    return Error{fmt::format("{}: {}", what, checked.error().message)};
  object.bop_id = *id;
  object.instance = as_integer(member(entry, "instance")).value_or(counts[object.object]);
  ++counts[object.object];
  object.camera_from_object = *pose;
  return object;
}

Result<void> read_ground_truth(const fs::path& scene, SequenceTable& table) {
  const fs::path file = scene / "scene_gt.json";
  // A dangling link or a pipe is ground truth that cannot be read, not none.
  table.has_ground_truth = is_there(file);
  if (!table.has_ground_truth) return {};
  const auto truth = read_json(file);
  if (!truth) return truth.error();
  const auto members = numbered_members(*truth, file.string());
  if (!members) return members.error();
  const std::map<int, const nlohmann::json*> lists(members->begin(), members->end());
  Result<nlohmann::json> info = nlohmann::json();
  if (is_there(scene / "scene_gt_info.json")) info = read_json(scene / "scene_gt_info.json");
  if (!info) return info.error();
  Names names;
  if (const auto models = find_models_info(scene)) {
    auto read = read_models_info(*models);
    if (!read) return read.error();
    names = std::move(*read);
  }
  std::size_t num_unnamed = 0;
  for (ListedView& view : table.views) {
    const auto entry = lists.find(view.image_id);
    if (entry == lists.end()) {
      ++num_unnamed;
      continue;
    }
    const nlohmann::json& list = *entry->second;
    const std::string what = fmt::format("{}: image {}", file.string(), view.image_id);
    if (!list.is_array()) return Error{what + ": expected a list of objects"};
    std::map<std::string, int> counts;
    for (std::size_t i = 0; i < list.size(); ++i) {
      auto object = parse_object(list[i], names, counts, what);
      if (!object) return object.error();
      object->visible_share = visible_share(*info, view.image_id, i);
      view.ground_truth.push_back(std::move(*object));
    }
  }
  if (num_unnamed > 0)
    table.notes.push_back(fmt::format("scene_gt.json does not name {} of {} images: they count as without objects",
                                      num_unnamed, table.views.size()));
  return {};
}

}  // namespace

bool is_bop_scene(const fs::path& directory) { return is_file(directory / "scene_camera.json"); }

Result<SequenceTable> read_bop_scene(const fs::path& directory) {
  const fs::path file = directory / "scene_camera.json";
  const auto json = read_json(file);
  if (!json) return json.error();
  const auto cameras = numbered_members(*json, file.string());
  if (!cameras) return cameras.error();
  if (cameras->empty()) return file_error(file, "names no image");
  SequenceTable table;
  table.format = "bop";
  const auto scene_id = parse_integer(folder_name(directory));
  table.scene_id = scene_id && *scene_id >= 0 && *scene_id <= INT32_MAX ? static_cast<int>(*scene_id) : 0;
  int num_poses = 0;
  for (const auto& [image_id, entry] : *cameras) {
    bool has_pose = false;
    auto view = parse_camera(directory, image_id, *entry, has_pose);
    if (!view) return view.error();
    num_poses += has_pose ? 1 : 0;
    table.views.push_back(std::move(*view));
  }
  table.has_poses = num_poses == static_cast<int>(table.views.size());
  if (const auto done = read_ground_truth(directory, table); !done) return done.error();
  note_unnamed_images(directory, table);
  return table;
}

SequenceResult open_bop_scene(const fs::path& directory) {
  auto table = read_bop_scene(directory);
  if (!table) return table.error();
  return make_listed_sequence(std::move(*table));
}

}  // namespace resight::io
