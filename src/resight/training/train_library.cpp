// SPDX-License-Identifier: Apache-2.0
#include "resight/training/train_library.hpp"

#include <fmt/format.h>

#include <map>

namespace resight {
namespace {

constexpr double kUsualDiameter_m = 2;  // Larger ones are mostly in another unit.

bool is_usable_surface(const std::optional<PointCloud>& surface) {
  return surface.has_value() && surface->has_colors();
}

void set_surface(ObjectModel& model, PointCloud surface) {
  model.surface = std::move(surface);
  model.center = centroid(model.surface.points);
  model.diameter_m = diameter(model.surface.points);
}

Result<ObjectModel> train_from_views(const ModelSource& source, const TrainOptions& options) {
  if (source.mesh.has_value()) {
    Result<PointCloud> surface = train_surface(source.name, *source.mesh, options);
    if (!surface.ok()) return surface.error();
    Result<ObjectFeatures> features = train_features(source.name, source.views, options);
    if (!features.ok()) return features.error();
    ObjectModel model{.name = source.name,
                      .surface = {},
                      .sift = encode(features->sift),
                      .shot = encode(features->shot),
                      .symmetries = {}};
    set_surface(model, *std::move(surface));
    return model;
  }
  Result<ObjectModel> model = train_object(source.name, source.views, options);
  if (!model.ok() || !is_usable_surface(source.surface)) return model;
  Result<PointCloud> surface = train_surface(source.name, *source.surface, options);
  if (!surface.ok()) return surface.error();
  if (!model->surface.has_colors()) surface->colors.clear();  // Views show whether the colours were measured.
  set_surface(*model, *std::move(surface));
  return model;
}

Result<ObjectModel> train_from_any(const ModelSource& source, const TrainOptions& options) {
  if (!source.views.empty()) return train_from_views(source, options);
  if (source.mesh.has_value()) return train_object(source.name, *source.mesh, options);
  if (source.surface.has_value()) return train_object(source.name, *source.surface, options);
  return Error{fmt::format("model '{}': neither training views nor a mesh nor a cloud", source.name)};
}

// Duplicate names would make detections ambiguous. Reported before hours of training.
Result<void> check_names(std::span<const ModelLocation> locations) {
  std::map<std::string, const ModelLocation*> seen;
  for (const ModelLocation& location : locations) {
    const auto [place, is_new] = seen.emplace(location.name, &location);
    if (!is_new) {
      return Error{fmt::format("two models are named '{}': {} and {}", location.name, place->second->path.string(),
                               location.path.string())};
    }
  }
  return {};
}

Result<void> check_source(const ModelSource& source) {
  if (!source.views.empty())
    if (auto checked = check_training_input(source.name, source.views); !checked.ok()) return checked;
  if (source.mesh.has_value()) return check_training_input(source.name, *source.mesh);
  const bool is_used = source.views.empty() || is_usable_surface(source.surface);
  return source.surface.has_value() && is_used ? check_training_input(source.name, *source.surface) : Result<void>();
}

Error training_error(const ModelLocation& location, const Error& error) {
  return Error{fmt::format("{}: {}", location.path.string(), error.message)};
}

// Reads every model once before hours of training, so that a mistake in the last one does not lose the others.
Result<void> check_models(std::span<const ModelLocation> locations) {
  std::vector<ObjectModel> ids;
  for (const ModelLocation& location : locations) {
    const Result<ModelSource> source = read_model(location);
    if (!source.ok()) return source.error();
    if (const Result<void> checked = check_source(*source); !checked.ok())
      return training_error(location, checked.error());
    ObjectModel& model = ids.emplace_back();
    model.name = source->name;
    model.bop_id = source->bop_id;
  }
  return assign_bop_ids(ids);
}

ObjectSymmetries find_undeclared(const PointCloud& surface, const TrainOptions& options) {
  SymmetryOptions symmetry = options.symmetry;
  symmetry.num_threads = options.num_threads;
  return find_symmetries(surface, symmetry);
}

ObjectSymmetries find_shape_symmetries(PointCloud surface, const TrainOptions& options) {
  surface.colors.clear();
  return find_undeclared(surface, options);
}

void warn_about(const ObjectModel& model, const ModelSource& source, const std::string& path,
                const TrainWarning& warning) {
  for (const std::string& line : source.warnings) warning(line);
  if (model.sift.size() + model.shot.size() == 0)
    warning(fmt::format("{}: the object has no features and will not be recognised", path));
  if (model.diameter_m > kUsualDiameter_m)
    warning(fmt::format("{}: the object is {:.1f} m across: is its unit right?", path, model.diameter_m));
}

}  // namespace

Result<ObjectModel> train_object(const ModelSource& source, const TrainOptions& options) {
  Result<ObjectModel> model = train_from_any(source, options);
  if (!model.ok()) return model;
  model->bop_id = source.bop_id;
  if (source.symmetries_known || !source.symmetries.none())
    model->symmetries = source.symmetries;
  else if (options.find_symmetries)
    model->symmetries = find_undeclared(model->surface, options);
  if (options.find_symmetries && model->surface.has_colors())
    model->shape_symmetries = find_shape_symmetries(model->surface, options);
  return model;
}

Result<ModelLibrary> train_library(std::span<const ModelLocation> locations, const TrainOptions& options,
                                   const TrainProgress& progress, const TrainWarning& warning) {
  options.check();
  if (locations.empty()) return Error{"no models to train from"};
  const Result<void> names = check_names(locations);
  if (!names.ok()) return names.error();
  if (const Result<void> readable = check_models(locations); !readable.ok()) return readable.error();
  ModelLibrary library;
  library.options_hash = options.hash();
  library.surface_voxel_m = static_cast<float>(options.surface_voxel_m);
  const int count = static_cast<int>(locations.size());
  for (int i = 0; i < count; ++i) {
    const ModelLocation& location = locations[i];
    if (progress) progress(i, count, location.name);
    Result<ModelSource> source = read_model(location);
    if (!source.ok()) return source.error();
    Result<ObjectModel> model = train_object(*source, options);
    if (!model.ok()) return training_error(location, model.error());
    if (warning) warn_about(*model, *source, location.path.string(), warning);
    library.objects.push_back(*std::move(model));
  }
  const Result<void> ids = assign_bop_ids(library.objects);
  if (!ids.ok()) return ids.error();
  return library;
}

Result<void> assign_bop_ids(std::vector<ObjectModel>& objects) {
  std::map<std::string, int> names;
  std::map<int, std::string> taken;
  for (const ObjectModel& object : objects) {
    if (++names[object.name] > 1) return Error{fmt::format("two models are named '{}'", object.name)};
    if (object.bop_id < 0)
      return Error{fmt::format("model '{}': obj_id {} (must be >= 1)", object.name, object.bop_id)};
    if (object.bop_id == 0) continue;
    const auto [place, is_new] = taken.emplace(object.bop_id, object.name);
    if (!is_new)
      return Error{
          fmt::format("models '{}' and '{}' have the same obj_id {}", place->second, object.name, object.bop_id)};
  }
  int next = 1;
  for (ObjectModel& object : objects) {
    if (object.bop_id != 0) continue;
    while (taken.contains(next)) ++next;
    object.bop_id = next++;
  }
  return {};
}

}  // namespace resight
