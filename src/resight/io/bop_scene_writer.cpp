// SPDX-License-Identifier: Apache-2.0
#include "resight/io/internal/bop_scene_writer.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "resight/io/images.hpp"
#include "resight/io/internal/bop_dataset.hpp"
#include "resight/io/internal/json.hpp"
#include "resight/io/internal/sequences.hpp"
#include "resight/io/internal/text.hpp"

namespace resight::io {
namespace {

constexpr double kUnknownShare = -1;  ///< As visib_fract.

class BopSequenceWriter final : public SequenceWriter {
 public:
  BopSequenceWriter(PendingDirectory directory, std::map<std::string, int> ids, const SequenceContent& content)
      : directory_(std::move(directory)), scene_(directory_.path(), std::move(ids)), content_(content) {}

  [[nodiscard]] Result<void> write_view(const RgbdFrame& frame,
                                        const std::vector<GroundTruthObject>& ground_truth) override {
    if (const auto done = check_frame(frame); !done) return done;
    const auto id = scene_.write_view(frame, ground_truth, content_.has_poses);
    if (!id) return id.error();
    names_.push_back(bop_number(*id));
    return {};
  }
  [[nodiscard]] const std::vector<std::string>& view_names() const override { return names_; }
  [[nodiscard]] Result<void> add_file(const std::string& name, std::string_view bytes) override {
    return write_file(directory_.path() / name, bytes);
  }
  [[nodiscard]] Result<void> finish() override {
    if (scene_.num_views() == 0) return file_error(directory_.final_path(), "no view was written");
    if (const auto done = scene_.finish(content_.has_ground_truth); !done) return done;
    return directory_.commit();
  }

 private:
  PendingDirectory directory_;
  BopSceneWriter scene_;
  SequenceContent content_;
  std::vector<std::string> names_;
};

/// The obj_ids by name in the other scenes of a split: the folders beside this one whose names are numbers, too.
Result<std::map<std::string, int>> read_ids_of_other_scenes(const fs::path& directory) {
  std::map<std::string, int> ids;
  if (!parse_integer(folder_name(directory))) return ids;
  const fs::path split = fs::absolute(directory / "..").lexically_normal();
  for (const std::string& name : list_directories(split)) {
    const fs::path file = split / name / "scene_gt.json";
    if (!parse_integer(name) || !is_there(file)) continue;
    const auto truth = read_json(file);
    if (!truth) return truth.error();
    for (const nlohmann::json& objects : *truth)
      for (const nlohmann::json& object : objects)
        if (const auto id = as_integer(member(object, "obj_id")))
          ids.try_emplace(as_text(member(object, "name")).value_or(bop_object_name(*id)), *id);
  }
  return ids;
}

}  // namespace

double choose_depth_unit_m(const Image<float>& depth_m) {
  float farthest_m = 0;
  for (const float z : depth_m.data())
    if (z > farthest_m) farthest_m = z;
  return farthest_m < 6.5F ? 1e-4 : 1e-3;
}

Result<int> BopSceneWriter::find_id(const GroundTruthObject& object) {
  const auto known = ids_.find(object.object);
  if (known != ids_.end()) {
    if (object.bop_id > 0 && object.bop_id != known->second)
      return file_error(directory_, fmt::format("object '{}' has the ids {} and {} in this data set", object.object,
                                                known->second, object.bop_id));
    return known->second;
  }
  int id = object.bop_id;
  const auto is_used = [&](int candidate) {
    return std::ranges::any_of(ids_, [&](const auto& entry) { return entry.second == candidate; });
  };
  if (id > 0 && is_used(id))
    return file_error(directory_, fmt::format("the id {} of object '{}' belongs to another one", id, object.object));
  if (id <= 0)
    for (id = 1; is_used(id);) ++id;
  ids_[object.object] = id;
  return id;
}

Result<int> BopSceneWriter::write_view(const RgbdFrame& frame, const std::vector<GroundTruthObject>& ground_truth,
                                       bool with_camera_pose) {
  const auto number = trailing_number(frame.name);
  const int image_id = number && *number > last_image_id_ ? *number : last_image_id_ + 1;
  last_image_id_ = image_id;
  ++num_views_;
  const double unit_m = choose_depth_unit_m(frame.depth_m);
  const std::string file = bop_number(image_id) + ".png";
  if (const auto done = write_color(directory_ / "rgb" / file, frame.color); !done) return done.error();
  if (const auto done = write_depth(directory_ / "depth" / file, frame.depth_m, unit_m); !done) return done.error();

  const std::string key = std::to_string(image_id);
  const Camera& k = frame.camera;
  nlohmann::json& camera = cameras_[key];
  camera = {{"cam_K", {k.fx, 0.0, k.cx, 0.0, k.fy, k.cy, 0.0, 0.0, 1.0}}, {"depth_scale", unit_m == 1e-4 ? 0.1 : 1.0}};
  if (with_camera_pose) {
    const Rigid3 camera_from_world = frame.world_from_camera.inverse();
    camera["cam_R_w2c"] = rotation_to_json(camera_from_world.rotation);
    camera["cam_t_w2c"] = translation_to_json_mm(camera_from_world.translation);
  }
  truth_[key] = nlohmann::json::array();
  info_[key] = nlohmann::json::array();
  std::map<std::string, int> counts;
  for (const GroundTruthObject& object : ground_truth) {
    const auto id = find_id(object);
    if (!id) return id.error();
    nlohmann::json entry = {{"obj_id", *id},
                            {"cam_R_m2c", rotation_to_json(object.camera_from_object.rotation)},
                            {"cam_t_m2c", translation_to_json_mm(object.camera_from_object.translation)}};
    // Our two additional keys, which keep names and instances without a models folder. Other readers skip them.
    if (object.object != bop_object_name(*id)) entry["name"] = object.object;
    if (object.instance != counts[object.object]++) entry["instance"] = object.instance;
    truth_[key].push_back(std::move(entry));
    const bool is_known = !std::isnan(object.visible_share);
    knows_visibility_ = knows_visibility_ || is_known;
    info_[key].push_back({{"visib_fract", is_known ? object.visible_share : kUnknownShare}});
  }
  return image_id;
}

Result<void> BopSceneWriter::write_object_mask(int image_id, int index, const Image<std::uint8_t>& mask) const {
  const std::string file = fmt::format("{}_{}.png", bop_number(image_id), bop_number(index));
  if (const auto done = write_mask(directory_ / "mask" / file, mask); !done) return done;
  return write_mask(directory_ / "mask_visib" / file, mask);
}

Result<void> BopSceneWriter::finish(bool with_ground_truth) const {
  if (const auto done = write_json(directory_ / "scene_camera.json", cameras_); !done) return done;
  if (!with_ground_truth) return {};
  if (const auto done = write_json(directory_ / "scene_gt.json", truth_); !done) return done;
  if (!knows_visibility_) return {};
  return write_json(directory_ / "scene_gt_info.json", info_);
}

Result<std::unique_ptr<SequenceWriter>> create_bop_scene(const fs::path& directory, const SequenceContent& content) {
  std::map<std::string, int> ids;
  if (const auto models = find_models_info(directory)) {
    const auto infos = read_models_info(*models);
    if (!infos) return infos.error();
    for (const auto& [id, info] : *infos) ids[info.name] = id;
  } else {
    auto used = read_ids_of_other_scenes(directory);
    if (!used) return used.error();
    ids = std::move(*used);
  }
  auto pending = PendingDirectory::create(directory);
  if (!pending) return pending.error();
  return std::unique_ptr<SequenceWriter>(
      std::make_unique<BopSequenceWriter>(std::move(*pending), std::move(ids), content));
}

}  // namespace resight::io
