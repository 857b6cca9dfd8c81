// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "resight/io/images.hpp"
#include "resight/io/internal/bop_dataset.hpp"
#include "resight/io/internal/files.hpp"
#include "resight/io/internal/model_files.hpp"
#include "resight/io/internal/sequences.hpp"
#include "resight/io/internal/text.hpp"
#include "resight/io/mesh.hpp"
#include "resight/io/ply.hpp"

namespace resight::io {
namespace {

constexpr double kMetresPerMillimetre = 1e-3;

bool is_model_file(const std::string& name) {
  return extension_of(name) == "ply" && parse_bop_object_name(fs::path(name).stem().string());
}

bool is_models_folder(const fs::path& directory) {
  return is_there(directory / "models_info.json") || std::ranges::any_of(list_files(directory), is_model_file);
}

Result<std::vector<ModelLocation>> list_models_folder(const fs::path& folder) {
  std::map<int, ModelLocation> found;
  const auto add = [&](int id) {
    found[id] = {bop_object_name(id), id, folder / (bop_object_name(id) + ".ply"), "bop"};
  };
  for (const std::string& name : list_files(folder)) {
    if (!is_model_file(name)) continue;
    const int id = *parse_bop_object_name(fs::path(name).stem().string());
    add(id);
    found[id].path = folder / name;
  }
  if (is_there(folder / "models_info.json")) {
    const auto infos = read_models_info(folder / "models_info.json");
    if (!infos) return infos.error();
    for (const auto& [id, info] : *infos) {
      if (!found.contains(id)) add(id);  // only training views exist
      found[id].name = info.name;
    }
  }
  std::vector<ModelLocation> locations;
  for (auto& [id, location] : found) locations.push_back(std::move(location));
  return locations;
}

/// Lists scenes of single objects, which are named by their obj_id.
std::vector<ModelLocation> list_training_split(const fs::path& split) {
  std::vector<ModelLocation> locations;
  for (const std::string& name : list_directories(split)) {
    const auto id = parse_integer(name);
    if (id && *id > 0 && *id <= INT32_MAX && is_bop_scene(split / name) && is_file(split / name / "scene_gt.json"))
      locations.push_back({bop_object_name(static_cast<int>(*id)), static_cast<int>(*id), split / name, "bop"});
  }
  return locations;
}

Result<Image<std::uint8_t>> read_object_mask(const fs::path& scene, const ListedView& view, const RgbdFrame& frame) {
  for (const char* folder : {"mask_visib", "mask"}) {
    const fs::path file = scene / folder / (view.name + "_000000.png");
    if (!is_file(file)) continue;
    auto mask = read_mask(file);
    if (mask && (mask->width() != frame.camera.width || mask->height() != frame.camera.height))
      return file_error(file, "must have the size of its view");
    return mask;
  }
  // Training images without masks show only the object.
  Image<std::uint8_t> mask(frame.camera.width, frame.camera.height, 0);
  for (std::size_t i = 0; i < mask.size(); ++i) mask[i] = std::isnan(frame.depth_m[i]) ? 0 : 255;
  return mask;
}

/// Views of a scene that shows only this object; empty if the scene shows others.
Result<std::vector<TrainingView>> read_training_scene(const fs::path& scene, int bop_id, std::string* name) {
  auto table = read_bop_scene(scene);
  if (!table) return table.error();
  std::vector<TrainingView> views;
  const auto sequence = make_listed_sequence(*table);
  for (int i = 0; i < sequence->num_views(); ++i) {
    const ListedView& listed = table->views[i];
    if (listed.ground_truth.size() != 1 || listed.ground_truth[0].bop_id != bop_id) continue;
    auto frame = sequence->read_view(i);
    if (!frame) return frame.error();
    frame->world_from_camera = listed.ground_truth[0].camera_from_object.inverse();
    auto mask = read_object_mask(scene, listed, *frame);
    if (!mask) return mask.error();
    views.push_back({std::move(*frame), std::move(*mask)});
    if (name != nullptr) *name = listed.ground_truth[0].object;
  }
  return views;
}

Result<std::vector<TrainingView>> find_training_views(const fs::path& dataset, int bop_id) {
  for (const std::string& split : list_directories(dataset)) {
    const fs::path scene = dataset / split / bop_number(bop_id);
    if (!split.starts_with("train") || split == "train_pbr" || !is_bop_scene(scene)) continue;
    auto views = read_training_scene(scene, bop_id, nullptr);
    if (!views || !views->empty()) return views;
  }
  return std::vector<TrainingView>{};
}

/// Reads a mesh if the PLY has faces, else its points as the surface.
Result<void> read_geometry(const fs::path& file, double metres_per_unit, ModelSource& model) {
  auto content = read_ply(file);
  if (!content) return content.error();
  const ReadMeshOptions options{.metres_per_unit = metres_per_unit};
  if (!content->mesh.faces.empty()) {
    auto mesh = read_mesh(file, options);
    if (!mesh) return mesh.error();
    model.mesh = std::move(mesh->mesh);
    model.warnings = std::move(mesh->warnings);
    return {};
  }
  auto cloud = read_ply_cloud(file, metres_per_unit);
  if (!cloud) return cloud.error();
  model.surface = clean_normals(std::move(*cloud));
  return check_size(model.surface->points, options, file);
}

}  // namespace

Result<std::vector<ModelLocation>> find_bop_models(const fs::path& directory) {
  if (is_models_folder(directory)) return list_models_folder(directory);
  for (const char* folder : {"models", "models_fine", "models_cad", "models_eval"})
    if (is_models_folder(directory / folder)) return list_models_folder(directory / folder);
  if (auto locations = list_training_split(directory); !locations.empty()) return locations;
  for (const std::string& split : list_directories(directory))
    if (split.starts_with("train") && split != "train_pbr")
      if (auto locations = list_training_split(directory / split); !locations.empty()) return locations;
  return std::vector<ModelLocation>{};
}

Result<ModelSource> read_bop_model(const ModelLocation& location) {
  ModelSource model;
  model.name = location.name;
  model.bop_id = location.bop_id;
  if (is_bop_scene(location.path)) {
    auto views = read_training_scene(location.path, location.bop_id, &model.name);
    if (!views) return views.error();
    if (views->empty())
      return file_error(location.path,
                        fmt::format("no image shows only object {}; expected a training scene of it", location.bop_id));
    model.views = std::move(*views);
    return model;
  }
  const fs::path folder = fs::absolute(location.path).lexically_normal().parent_path();
  if (is_there(folder / "models_info.json")) {
    const auto infos = read_models_info(folder / "models_info.json");
    if (!infos) return infos.error();
    if (const auto it = infos->find(location.bop_id); it != infos->end()) {
      model.symmetries = it->second.symmetries;
      model.symmetries_known = true;
    }
  }
  const double metres_per_unit = location.metres_per_unit.value_or(kMetresPerMillimetre);
  if (is_file(location.path))
    if (const auto done = read_geometry(location.path, metres_per_unit, model); !done) return done.error();
  if (model.mesh) return model;
  auto views = find_training_views(folder.parent_path(), location.bop_id);
  if (!views) return views.error();
  model.views = std::move(*views);
  if (model.views.empty() && !model.surface)
    return file_error(location.path, "is missing, and there are no training views of it");
  return model;
}

}  // namespace resight::io
