// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "resight/core/check.hpp"
#include "resight/io/bop_models.hpp"
#include "resight/io/internal/bop_dataset.hpp"
#include "resight/io/internal/bop_scene_writer.hpp"
#include "resight/io/internal/json.hpp"
#include "resight/io/internal/model_info.hpp"
#include "resight/io/ply.hpp"

namespace resight {
namespace {

constexpr double kMillimetresPerMetre = 1000;

/// Points that determine the extent of the object: those of its mesh, of its surface, or of its views.
std::vector<Eigen::Vector3f> extent_points(const ModelSource& model) {
  if (model.mesh) return model.mesh->vertices;
  if (model.surface) return model.surface->points;
  PointCloud cloud;
  for (const TrainingView& view : model.views) {
    PointCloud seen;
    for (int v = 0; v < view.mask.height(); ++v)
      for (int u = 0; u < view.mask.width(); ++u)
        if (view.mask(u, v) != 0 && !std::isnan(view.frame.depth_m(u, v)))
          seen.points.push_back(
              (view.frame.world_from_camera * view.frame.camera.unproject(u, v, view.frame.depth_m(u, v)))
                  .cast<float>());
    cloud.append(voxel_downsample(seen, 0.003));
  }
  return voxel_downsample(cloud, 0.003).points;
}

nlohmann::json make_info(const ModelSource& model) {
  const auto points = extent_points(model);
  Eigen::AlignedBox3f box;
  for (const Eigen::Vector3f& p : points) box.extend(p);
  nlohmann::json info = {{"name", model.name}};
  if (!box.isEmpty()) {
    info["diameter"] = diameter(points) * kMillimetresPerMetre;
    constexpr const char* kAxes[] = {"x", "y", "z"};
    for (int k = 0; k < 3; ++k) {
      info[std::string("min_") + kAxes[k]] = box.min()[k] * kMillimetresPerMetre;
      info[std::string("size_") + kAxes[k]] = box.sizes()[k] * kMillimetresPerMetre;
    }
  }
  io::add_symmetries(info, model.symmetries);
  return info;
}

}  // namespace

struct BopModelsWriter::State {
  std::filesystem::path dataset;
  io::PendingDirectory models;
  std::optional<io::PendingDirectory> train;
  nlohmann::json infos = nlohmann::json::object();

  Result<void> write_views(const ModelSource& model, int bop_id) {
    if (!train) {
      auto pending = io::PendingDirectory::create(dataset / "train");
      if (!pending) return pending.error();
      train = std::move(*pending);
    }
    io::BopSceneWriter scene(train->path() / io::bop_number(bop_id), {{model.name, bop_id}});
    for (const TrainingView& view : model.views) {
      if (const auto done = check_frame(view.frame); !done) return done;
      GroundTruthObject object;
      object.object = model.name;
      object.bop_id = bop_id;
      object.camera_from_object = view.frame.world_from_camera.inverse();
      const auto image_id = scene.write_view(view.frame, {object}, false);
      if (!image_id) return image_id.error();
      if (const auto done = scene.write_object_mask(*image_id, 0, view.mask); !done) return done;
    }
    return scene.finish();
  }
};

BopModelsWriter::BopModelsWriter(std::unique_ptr<State> state) : state_(std::move(state)) {}
BopModelsWriter::~BopModelsWriter() = default;

Result<std::unique_ptr<BopModelsWriter>> BopModelsWriter::create(const std::filesystem::path& dataset) {
  auto models = io::PendingDirectory::create(dataset / "models");
  if (!models) return models.error();
  auto state = std::make_unique<State>(State{dataset, std::move(*models), std::nullopt});
  return std::unique_ptr<BopModelsWriter>(new BopModelsWriter(std::move(state)));
}

Result<void> BopModelsWriter::write_model(const ModelSource& model, int bop_id) {
  require(bop_id > 0, "BopModelsWriter::write_model: bop_id must be positive");
  const std::string key = std::to_string(bop_id);
  require(!state_->infos.contains(key), "BopModelsWriter::write_model: two models with the same bop_id");
  require(model.mesh || model.surface || !model.views.empty(), "BopModelsWriter::write_model: the model is empty");
  const auto file = state_->models.path() / (io::bop_object_name(bop_id) + ".ply");
  if (model.mesh) {
    if (const auto done = write_ply(file, *model.mesh, kMillimetresPerMetre); !done) return done;
  } else if (model.surface) {
    if (const auto done = write_ply(file, *model.surface, kMillimetresPerMetre); !done) return done;
  }
  state_->infos[key] = make_info(model);
  return model.views.empty() ? Result<void>() : state_->write_views(model, bop_id);
}

Result<void> BopModelsWriter::finish() {
  if (state_->infos.empty()) return io::file_error(state_->dataset, "no model was written");
  if (const auto done = io::write_json(state_->models.path() / "models_info.json", state_->infos); !done) return done;
  if (state_->train)
    if (const auto done = state_->train->commit(); !done) return done;
  return state_->models.commit();
}

Result<std::vector<int>> assign_bop_ids(std::span<const int> ids) {
  std::set<int> taken;
  for (const int id : ids)
    if (id < 0 || (id > 0 && !taken.insert(id).second)) return Error{fmt::format("two models have the obj_id {}", id)};
  std::vector<int> assigned(ids.begin(), ids.end());
  int next = 1;
  for (int& id : assigned) {
    if (id > 0) continue;
    while (taken.contains(next)) ++next;
    id = next++;
  }
  return assigned;
}

}  // namespace resight
