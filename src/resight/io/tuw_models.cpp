// SPDX-License-Identifier: Apache-2.0
#include "resight/io/tuw_models.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>

#include "resight/core/check.hpp"
#include "resight/io/images.hpp"
#include "resight/io/internal/files.hpp"
#include "resight/io/internal/json.hpp"
#include "resight/io/internal/model_files.hpp"
#include "resight/io/internal/model_info.hpp"
#include "resight/io/internal/text.hpp"
#include "resight/io/mesh.hpp"
#include "resight/io/organized_pcd.hpp"
#include "resight/io/pose_text.hpp"

namespace resight {
namespace {

using io::fs::path;
constexpr std::string_view kCloud = "cloud_";

bool is_view_cloud(const std::string& name) {
  return name.find(kCloud) != name.npos && io::extension_of(name) == "pcd";
}

/// The companion file of a view: the last "cloud_" of its name is replaced, as in V4R.
path companion(const path& cloud, std::string_view prefix, std::string_view extension) {
  std::string stem = cloud.stem().string();
  stem.replace(stem.rfind(kCloud), kCloud.size(), prefix);
  return cloud.parent_path() / (stem + std::string(extension));
}

Result<Image<std::uint8_t>> read_indices(const path& file, int width, int height) {
  const auto text = io::read_file(file);
  if (!text) return text.error();
  Image<std::uint8_t> mask(width, height, 0);
  io::TextCursor cursor(*text);
  for (std::string_view token = cursor.next(); !token.empty(); token = cursor.next()) {
    const auto index = io::parse_integer(token);
    if (!index || *index < 0 || static_cast<std::size_t>(*index) >= mask.size())
      return io::file_error(file,
                            fmt::format("'{:.20}' is not a pixel index of an image of {}x{}", token, width, height));
    mask[static_cast<std::size_t>(*index)] = 255;
  }
  return mask;
}

Result<Image<std::uint8_t>> read_view_mask(const path& cloud, int width, int height) {
  const path indices = companion(cloud, "object_indices_", ".txt");
  const path image = companion(cloud, "mask_", ".png");
  if (io::is_file(indices) || !io::is_file(image)) return read_indices(indices, width, height);
  auto mask = read_mask(image);
  if (mask && (mask->width() != width || mask->height() != height))
    return io::file_error(image, "must have the size of its view");
  return mask;
}

Result<TrainingView> read_view(const path& cloud_file) {
  const auto cloud = read_pcd(cloud_file);
  if (!cloud) return cloud.error();
  auto frame = to_frame(*cloud, cloud_file.string());
  if (!frame) return frame.error();
  const auto object_from_camera = read_pose(companion(cloud_file, "pose_", ".txt"));
  if (!object_from_camera) return object_from_camera.error();
  frame->name = cloud_file.stem().string();
  frame->world_from_camera = *object_from_camera * find_points_from_camera(cloud->points);
  if (const auto done = check_frame(*frame); !done) return io::file_error(cloud_file, done.error().message);
  auto mask = read_view_mask(cloud_file, cloud->width, cloud->height);
  if (!mask) return mask.error();
  return TrainingView{std::move(*frame), std::move(*mask)};
}

Result<void> read_surface(const path& file, ModelSource& model) {
  const auto cloud = read_pcd(file);
  if (!cloud) return cloud.error();
  model.surface = io::clean_normals(to_point_cloud(*cloud));
  if (model.surface->empty()) return io::file_error(file, "holds no finite point");
  return check_size(model.surface->points, {}, file);
}

Result<void> write_training_view(const path& views, int number, const TrainingView& view) {
  if (const auto done = check_frame(view.frame); !done) return done;
  require(view.mask.width() == view.frame.camera.width && view.mask.height() == view.frame.camera.height,
          "write_tuw_model: the mask must have the size of its view");
  PcdCloud cloud = to_pcd_cloud(view.frame);
  cloud.viewpoint = Rigid3::identity();  // the pose has a file of its own; PCL would apply both
  const std::string digits = fmt::format("{:08}", number);
  if (const auto done = write_pcd(views / fmt::format("cloud_{}.pcd", digits), cloud); !done) return done;
  const auto done =
      io::write_file(views / fmt::format("pose_{}.txt", digits), format_pose(view.frame.world_from_camera) + "\n");
  if (!done) return done;
  std::string indices;
  for (std::size_t i = 0; i < view.mask.size(); ++i)
    if (view.mask[i] != 0) fmt::format_to(std::back_inserter(indices), "{}\n", i);
  return io::write_file(views / fmt::format("object_indices_{}.txt", digits), indices);
}

}  // namespace

namespace io {

Result<ModelExtras> read_model_extras(const fs::path& file) {
  ModelExtras extras;
  if (!is_file(file)) return extras;
  const auto json = read_json(file);
  if (!json) return json.error();
  auto symmetries = parse_symmetries(*json, file.string());
  if (!symmetries) return symmetries.error();
  extras.symmetries = std::move(*symmetries);
  extras.symmetries_known = json->contains("symmetries_discrete") || json->contains("symmetries_continuous");
  extras.bop_id = std::max(0, as_integer(member(*json, "obj_id")).value_or(0));
  return extras;
}

PointCloud clean_normals(PointCloud cloud) {
  if (!cloud.has_normals()) return cloud;
  std::vector<int> kept;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const float norm = cloud.normals[i].norm();
    if (!(std::isfinite(norm) && norm > 0.1F)) continue;
    cloud.normals[i] /= norm;
    kept.push_back(static_cast<int>(i));
  }
  if (kept.empty()) cloud.normals.clear();  // the file has an empty column of normals
  return kept.empty() || kept.size() == cloud.size() ? cloud : select(cloud, kept);
}

}  // namespace io

bool is_tuw_model(const path& directory) {
  return std::ranges::any_of(io::list_files(directory / "views"), is_view_cloud);
}

Result<ModelSource> read_tuw_model(const path& directory, const std::string& name) {
  ModelSource model;
  model.name = name;
  auto extras = io::read_model_extras(directory / "model_info.json");
  if (!extras) return extras.error();
  model.bop_id = extras->bop_id;
  model.symmetries = std::move(extras->symmetries);
  model.symmetries_known = extras->symmetries_known;
  for (const std::string& file : io::list_files(directory / "views")) {
    if (!is_view_cloud(file)) continue;
    auto view = read_view(directory / "views" / file);
    if (!view) return view.error();
    model.views.push_back(std::move(*view));
  }
  if (model.views.empty()) return io::file_error(directory, "holds no training views (expected views/cloud_*.pcd)");
  if (io::is_file(directory / "3D_model.pcd"))
    if (const auto done = read_surface(directory / "3D_model.pcd", model); !done) return done.error();
  return model;
}

Result<void> write_tuw_model(const path& directory, const std::string& name, std::span<const TrainingView> views,
                             const PointCloud* surface, const ObjectSymmetries& symmetries, int bop_id,
                             bool symmetries_known) {
  require(!views.empty(), "write_tuw_model: no views");
  if (!io::is_safe_name(name))
    return io::file_error(directory, "the model name '" + name + "' cannot be a folder name");
  auto pending = io::PendingDirectory::create(directory / name);
  if (!pending) return pending.error();
  int number = -1;
  for (const TrainingView& view : views) {
    const auto own = io::trailing_number(view.frame.name);
    number = own && *own > number ? *own : number + 1;
    if (const auto done = write_training_view(pending->path() / "views", number, view); !done) return done;
  }
  if (surface != nullptr)
    if (const auto done = write_pcd(pending->path() / "3D_model.pcd", to_pcd_cloud(*surface)); !done) return done;
  if (!symmetries.none() || symmetries_known || bop_id > 0) {
    nlohmann::json info = nlohmann::json::object();
    if (symmetries_known) info["symmetries_discrete"] = nlohmann::json::array();  // Declares that there are no others.
    if (bop_id > 0) info["obj_id"] = bop_id;
    io::add_symmetries(info, symmetries);
    if (const auto done = io::write_json(pending->path() / "model_info.json", info); !done) return done;
  }
  return pending->commit();
}

}  // namespace resight
