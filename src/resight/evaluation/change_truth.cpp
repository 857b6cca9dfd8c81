// SPDX-License-Identifier: Apache-2.0
#include "resight/evaluation/change_truth.hpp"

#include <algorithm>
#include <map>
#include <system_error>

#include "resight/core/files.hpp"
#include "resight/evaluation/locate_changes.hpp"
#include "resight/evaluation/placement_changes.hpp"
#include "resight/geometry/mesh_sampling.hpp"
#include "resight/io/event_file.hpp"
#include "resight/io/model_source.hpp"

namespace resight {
namespace {

namespace fs = std::filesystem;

constexpr double kUnknownSamplesPerSqM = 2.5e5;  // 2 mm apart.

ObjectEventKind kind_from(const std::string& text) {
  if (text == to_string(ObjectEventKind::kAdded)) return ObjectEventKind::kAdded;
  return text == to_string(ObjectEventKind::kMoved) ? ObjectEventKind::kMoved : ObjectEventKind::kRemoved;
}

Result<std::map<std::string, PointCloud>> read_unknown_surfaces(const fs::path& folder) {
  std::map<std::string, PointCloud> surfaces;
  std::error_code error;
  const bool is_there = fs::exists(folder, error);
  if (error) return file_error(folder, error.message());
  if (!is_there) return surfaces;
  const auto locations = find_models({folder});
  if (!locations) return locations.error();
  for (const ModelLocation& location : *locations) {
    const auto source = read_model(location);
    if (!source) return source.error();
    if (source->mesh) surfaces[source->name] = sample_surface(*source->mesh, kUnknownSamplesPerSqM);
  }
  return surfaces;
}

Result<std::vector<TruthView>> read_truth_views(const Sequence& sequence) {
  std::vector<TruthView> views;
  for (int v = 0; v < sequence.num_views(); ++v) {
    const auto pose = sequence.read_pose(v);
    if (!pose) return pose.error();
    auto objects = sequence.read_ground_truth(v);
    if (!objects) return objects.error();
    views.push_back({*pose, std::move(*objects)});
  }
  return views;
}

bool has_known_object(const std::vector<TruthView>& views, const ModelLibrary& library) {
  return std::ranges::any_of(views, [&](const TruthView& view) {
    return std::ranges::any_of(view.objects, [&](const auto& object) { return library.find(object.object) >= 0; });
  });
}

using Names = std::map<std::string, std::string>;

// Gives the objects the names of the library instead of those of the data set. Returns the new names by the old ones.
Names name_by_id(const ModelLibrary& library, std::vector<TruthView>& views) {
  Names names;
  for (TruthView& view : views)
    for (GroundTruthObject& object : view.objects) {
      const auto model = std::ranges::find(library.objects, object.bop_id, &ObjectModel::bop_id);
      if (object.bop_id <= 0 || model == library.objects.end()) continue;
      names[object.object] = model->name;
      object.object = model->name;
    }
  return names;
}

void rename_object(const Names& names, std::string& object) {
  if (const auto name = names.find(object); name != names.end()) object = name->second;
}

// A BOP scene without models_info.json names its objects by their obj_ids.
bool has_own_names(const std::vector<TruthView>& views) {
  return std::ranges::any_of(views, [](const TruthView& view) {
    return std::ranges::any_of(view.objects, [](const auto& object) { return !object.object.starts_with("obj_"); });
  });
}

// Returns the new names of objects that the library has under another name.
Names check_names(const ModelLibrary& library, SequenceTruth& truth) {
  const bool has_objects = std::ranges::any_of(truth.views, [](const TruthView& v) { return !v.objects.empty(); });
  if (!has_objects || has_known_object(truth.views, library)) return {};
  const bool has_names = has_own_names(truth.views);
  Names names = name_by_id(library, truth.views);
  if (!has_known_object(truth.views, library))
    truth.names = TruthNames::kNotInLibrary;
  else if (has_names)
    truth.names = TruthNames::kFoundById;
  return names;
}

Result<void> add_events(const fs::path& events, int num_views, const fs::path& unknown_models,
                        const ModelLibrary& library, const Names& new_names, SequenceTruth& truth) {
  auto changes = read_true_changes(events, num_views);
  if (!changes) return changes.error();
  for (TrueChange& change : *changes) rename_object(new_names, change.object);
  if (const auto located = locate_changes(truth.views, library, *changes); !located)
    return Error{events.string() + ": " + located.error().message};
  truth.changes = std::move(*changes);
  truth.former_places = former_places_of(*truth.changes, library);
  auto surfaces = read_unknown_surfaces(unknown_models);
  if (!surfaces) return surfaces.error();
  truth.unknown_surfaces = std::move(*surfaces);
  return {};
}

Result<void> add_chains(const fs::path& file, const Sequence& sequence, const ModelLibrary& library,
                        const Names& new_names, SequenceTruth& truth) {
  const auto chains = read_changes(file);
  if (!chains) return chains.error();
  auto named = resolve_changes(*chains, view_names(sequence), file.string());
  if (!named) return named.error();
  for (ObjectPlacement& placement : *named) rename_object(new_names, placement.object);
  const auto placements = locate_placements(*named, truth.views, library, file.string());
  if (!placements) return placements.error();
  const auto visibilities = observe_placements(*placements, truth.views, sequence, library);
  if (!visibilities) return visibilities.error();
  PlacementChanges inferred = infer_changes(*placements, *visibilities);
  truth.former_places = penalized_places(*placements, inferred.has_left, sequence.num_views());
  truth.changes = std::move(inferred.changes);
  return {};
}

}  // namespace

Result<std::vector<TrueChange>> read_true_changes(const fs::path& file, int num_views) {
  auto events = read_event_file(file, num_views);
  if (!events) return events.error();
  std::vector<TrueChange> changes;
  for (RecordedEvent& event : *events)
    changes.push_back({.view = event.view,
                       .kind = kind_from(event.kind),
                       .object = std::move(event.object),
                       .known = event.known,
                       .world_from_object_before = event.world_from_object_before,
                       .world_from_object_after = event.world_from_object_after});
  return changes;
}

std::vector<FormerPlace> former_places_of(const std::vector<TrueChange>& changes, const ModelLibrary& library) {
  std::vector<FormerPlace> places;
  for (const TrueChange& change : changes)
    if (change.known && change.world_from_object_before && library.find(change.object) >= 0)
      places.push_back({change.object, *change.world_from_object_before, change.view - 1});
  return places;
}

Result<SequenceTruth> read_sequence_truth(const Sequence& sequence, const ModelLibrary& library,
                                          const ChangeFiles& files, const fs::path& unknown_models) {
  SequenceTruth truth;
  Names new_names;
  if (sequence.has_ground_truth()) {
    auto views = read_truth_views(sequence);
    if (!views) return views.error();
    truth.views = std::move(*views);
    new_names = check_names(library, truth);
  }
  Result<void> done;
  if (!files.events.empty()) {
    done = add_events(files.events, sequence.num_views(), unknown_models, library, new_names, truth);
  } else if (!files.changes.empty() && sequence.has_ground_truth()) {
    done = add_chains(files.changes, sequence, library, new_names, truth);
  } else {
    truth.former_places = find_former_places(truth.views, library);
  }
  if (!done) return done.error();
  return truth;
}

}  // namespace resight
