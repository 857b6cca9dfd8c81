// SPDX-License-Identifier: Apache-2.0
#include "resight/io/model_source.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "resight/core/check.hpp"
#include "resight/core/names.hpp"
#include "resight/core/unfinished_folder.hpp"
#include "resight/io/internal/files.hpp"
#include "resight/io/internal/model_files.hpp"
#include "resight/io/internal/text.hpp"
#include "resight/io/mesh.hpp"
#include "resight/io/pcd.hpp"
#include "resight/io/ply.hpp"
#include "resight/io/tuw_models.hpp"

namespace resight {
namespace {

using io::fs::path;
using Locations = std::vector<ModelLocation>;

/// If several files have the same stem, the first of these extensions is the model. The others are conversions with
/// less content.
constexpr std::array<std::string_view, 6> kExtensions = {"obj", "glb", "gltf", "ply", "stl", "pcd"};

std::size_t extension_rank(const path& file) {
  return static_cast<std::size_t>(std::ranges::find(kExtensions, io::extension_of(file)) - kExtensions.begin());
}

std::string format_of(const path& file) { return io::extension_of(file) == "pcd" ? "cloud" : "mesh"; }

/// Scene views and damaged files in a folder are not models. To train from such a file, name it explicitly.
bool is_model_cloud(const path& file) {
  const auto size = read_pcd_size(file);
  return size.ok() && size->height == 1;
}

/// The model files directly in a directory, one per stem.
std::map<std::string, path> list_model_files(const path& directory) {
  std::map<std::string, path> files;
  for (const std::string& name : io::list_files(directory)) {
    const path file = directory / name;
    if (extension_rank(file) == kExtensions.size()) continue;
    if (io::extension_of(file) == "pcd" && !is_model_cloud(file)) continue;
    const auto [it, is_new] = files.try_emplace(file.stem().string(), file);
    if (!is_new && extension_rank(file) < extension_rank(it->second)) it->second = file;
  }
  return files;
}

Result<ModelLocation> locate_tuw_model(const path& directory) {
  const auto extras = io::read_model_extras(directory / "model_info.json");
  if (!extras) return extras.error();
  return ModelLocation{io::folder_name(directory), extras->bop_id, directory, "tuw"};
}

/// The mesh of a folder of its own: the only one, the one with the name of the folder, or "textured".
std::optional<path> find_own_mesh(const path& folder) {
  const auto files = list_model_files(folder);
  if (files.size() == 1) return files.begin()->second;
  for (const std::string& stem :
       {std::string("textured"), io::folder_name(folder), std::string("textured_simple"), std::string("model")})
    if (const auto it = files.find(stem); it != files.end()) return it->second;
  return std::nullopt;
}

/// The model_info.json beside a mesh or cloud; it may not exist.
path info_beside(const path& model) {
  return (model.has_parent_path() ? model.parent_path() : path(".")) / "model_info.json";
}

/// Whether model_info.json beside several models does not say which of them it describes.
bool is_ambiguous(const path& info, const path& model) {
  const path folder = info.parent_path();
  if (!io::is_file(info) || is_tuw_model(folder)) return false;
  const std::optional<path> own = find_own_mesh(folder);
  return own ? own->stem() != model.stem() : !list_model_files(folder).empty();
}

Result<io::ModelExtras> read_extras_beside(const path& model) {
  const path info = info_beside(model);
  return is_ambiguous(info, model) ? io::ModelExtras{} : io::read_model_extras(info);
}

/// The mesh of an object in the layout of YCB, `<object>/google_16k/textured.obj`: the same object also in other
/// resolutions and reconstructions, of which one is taken.
std::optional<path> find_ycb_mesh(const path& object) {
  for (const char* variant : {"google_16k", "google_64k", "google_512k", "tsdf", "poisson"})
    if (const auto mesh = find_own_mesh(object / variant); mesh && mesh->stem() == "textured") return mesh;
  return std::nullopt;
}

/// Names of files and folders that do not tell objects apart.
bool is_common_name(std::string_view name) {
  constexpr std::array<std::string_view, 10> kCommon = {"textured", "textured_simple", "textured_mesh", "model",
                                                        "mesh",     "google_16k",      "google_64k",    "meshes",
                                                        "visual",   "object"};
  return std::ranges::find(kCommon, io::to_lower(name)) != kCommon.end();
}

/// Models of one common name are called by the nearest folder above them that tells them apart. "textured" and
/// "google_16k" are never names of objects.
void name_by_folder(Locations& all) {
  std::map<std::string, int> counts;
  for (const ModelLocation& location : all) ++counts[location.name];
  for (ModelLocation& location : all) {
    const bool may_be_meant = !location.name.starts_with("textured") && !location.name.starts_with("google_");
    if ((counts[location.name] < 2 && may_be_meant) || !is_common_name(location.name)) continue;
    path folder = io::fs::absolute(location.path).lexically_normal();
    while (folder.has_stem() && is_common_name(folder.stem().string())) folder = folder.parent_path();
    if (folder.has_stem()) location.name = io::folder_name(folder);
  }
}

/// Collects models in a folder: files, sub-folders with one model, and (one level deeper) the same per class.
Result<void> collect(const path& directory, int levels_below, Locations& found) {
  for (const auto& [stem, file] : list_model_files(directory)) found.push_back({stem, 0, file, format_of(file)});
  for (const std::string& name : io::list_directories(directory)) {
    const path folder = directory / name;
    // Simulated data sets keep the meshes of unknown objects there.
    if (name == "unknown" && io::is_file(folder / "models" / "models_info.json")) continue;
    // Otherwise, half a model would be skipped without a word.
    if (const auto finished = check_finished(folder); !finished) return finished.error();
    if (is_tuw_model(folder)) {
      auto location = locate_tuw_model(folder);
      if (!location) return location.error();
      found.push_back(std::move(*location));
    } else if (const auto mesh = find_own_mesh(folder)) {
      found.push_back({name, 0, *mesh, format_of(*mesh)});
    } else if (const auto ycb = find_ycb_mesh(folder)) {
      found.push_back({name, 0, *ycb, format_of(*ycb)});
    } else if (levels_below > 0) {
      if (const auto done = collect(folder, levels_below - 1, found); !done) return done;
    }
  }
  return {};
}

constexpr std::string_view kExpectedModels =
    "expected a TUW model (views/cloud_*.pcd) or a folder of those, a BOP models folder or data set, a folder of "
    "meshes (ply, obj, glb, stl), a mesh file, or a cloud (ply, pcd)";

Result<Locations> find_under(const path& where) {
  Locations found;
  if (io::is_file(where)) {
    if (extension_rank(where) == kExtensions.size())
      return io::file_error(where, fmt::format("is no model file; {}", kExpectedModels));
    return Locations{{where.stem().string(), 0, where, format_of(where)}};
  }
  if (!io::is_folder(where)) return io::file_error(where, "no such file or directory");
  if (is_tuw_model(where)) {
    auto location = locate_tuw_model(where);
    if (!location) return location.error();
    return Locations{std::move(*location)};
  }
  auto bop = io::find_bop_models(where);
  if (!bop || !bop->empty()) return bop;
  // A folder with one mesh and its conversions is one model.
  if (const auto mesh = find_own_mesh(where); mesh && mesh->stem() == "textured")
    return Locations{{io::folder_name(where), 0, *mesh, format_of(*mesh)}};
  if (const auto ycb = find_ycb_mesh(where)) return Locations{{io::folder_name(where), 0, *ycb, format_of(*ycb)}};
  if (const auto done = collect(where, 1, found); !done) return done.error();
  if (found.empty()) return io::file_error(where, fmt::format("no model found; {}", kExpectedModels));
  return found;
}

Result<ModelSource> read_mesh_model(const ModelLocation& location, double metres_per_unit) {
  if (io::extension_of(location.path) == "ply") {
    const auto content = read_ply(location.path);
    if (!content) return content.error();
    if (content->mesh.faces.empty()) return io::read_cloud_model(location.path, location.name, metres_per_unit);
  }
  ReadMeshOptions options;
  options.metres_per_unit = metres_per_unit;
  auto mesh = read_mesh(location.path, options);
  if (!mesh) return mesh.error();
  ModelSource model;
  model.name = location.name;
  model.mesh = std::move(mesh->mesh);
  model.warnings = std::move(mesh->warnings);
  return model;
}

/// Adds what model_info.json beside a mesh or cloud declares.
Result<ModelSource> with_extras(Result<ModelSource> model, const ModelLocation& location) {
  if (!model) return model;
  auto extras = read_extras_beside(location.path);
  if (!extras) return extras.error();
  model->bop_id = location.bop_id;
  model->symmetries = std::move(extras->symmetries);
  model->symmetries_known = extras->symmetries_known;
  if (const path info = info_beside(location.path); is_ambiguous(info, location.path))
    model->warnings.push_back(fmt::format("{}: is ignored for '{}', because the folder has several models",
                                          info.string(), location.path.filename().string()));
  return model;
}

/// Around the pixels of the object, in its frame.
Eigen::AlignedBox3f object_box(const TrainingView& view) {
  const Image<float>& depth_m = view.frame.depth_m;
  Eigen::AlignedBox3f box;
  for (int v = 0; v < depth_m.height(); ++v)
    for (int u = 0; u < depth_m.width(); ++u)
      if (view.mask(u, v) != 0 && !std::isnan(depth_m(u, v)))
        box.extend((view.frame.world_from_camera * view.frame.camera.unproject(u, v, depth_m(u, v))).cast<float>());
  return box;
}

/// Views may see the object anywhere; what is made of them has the limits of a mesh.
Result<ModelSource> with_checked_views(Result<ModelSource> model, const path& file) {
  if (!model) return model;
  for (const TrainingView& view : model->views) {
    const auto done = check_near_origin(object_box(view), file);
    if (!done) return Error{fmt::format("{} (view '{}')", done.error().message, view.frame.name)};
  }
  return model;
}

Result<ModelSource> read_by_format(const ModelLocation& location) {
  if (location.format == "tuw") return read_tuw_model(location.path, location.name);
  if (location.format == "bop") return io::read_bop_model(location);
  const double metres_per_unit = location.metres_per_unit.value_or(1);
  if (location.format == "cloud")
    return with_extras(io::read_cloud_model(location.path, location.name, metres_per_unit), location);
  require(location.format == "mesh", "read_model: the format of the location must be tuw, bop, mesh or cloud");
  return with_extras(read_mesh_model(location, metres_per_unit), location);
}

}  // namespace

Result<Locations> find_models(const std::vector<path>& paths) {
  Locations all;
  for (const path& where : paths) {
    if (const auto finished = check_finished(where); !finished) return finished.error();
    auto found = find_under(where);
    if (!found) return found;
    all.insert(all.end(), found->begin(), found->end());
  }
  if (all.empty()) return Error{"no path to models was given"};
  name_by_folder(all);
  for (ModelLocation& location : all) {
    if (location.format != "mesh" && location.format != "cloud") continue;
    const auto extras = read_extras_beside(location.path);
    if (!extras) return extras.error();
    location.bop_id = extras->bop_id;
  }
  for (const ModelLocation& location : all)
    if (const auto finished = check_finished(location.path); !finished) return finished.error();
  for (const ModelLocation& location : all)
    if (const auto checked = check_object_name(location.name); !checked)
      return io::file_error(location.path, checked.error().message);
  std::ranges::stable_sort(all, io::natural_less, &ModelLocation::name);
  for (std::size_t i = 1; i < all.size(); ++i)
    if (all[i].name == all[i - 1].name)
      return Error{fmt::format("two models are called '{}': {} and {}", all[i].name, all[i - 1].path.string(),
                               all[i].path.string())};
  return all;
}

Result<ModelSource> read_model(const ModelLocation& location) {
  return with_checked_views(read_by_format(location), location.path);
}

}  // namespace resight
