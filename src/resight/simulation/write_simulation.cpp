// SPDX-License-Identifier: Apache-2.0
#include "resight/simulation/write_simulation.hpp"

#include <algorithm>
#include <cstdio>
#include <map>
#include <nlohmann/json.hpp>

#include "resight/core/check.hpp"
#include "resight/core/files.hpp"
#include "resight/core/json_text.hpp"
#include "resight/core/random.hpp"
#include "resight/io/bop_models.hpp"
#include "resight/io/tuw_models.hpp"
#include "resight/simulation/surface_sampling.hpp"

namespace resight {
namespace {

namespace fs = std::filesystem;
using nlohmann::ordered_json;

ordered_json pose_json(const std::optional<Rigid3>& pose) {
  if (!pose) return nullptr;
  ordered_json rows = ordered_json::array();
  const Eigen::Matrix4d m = pose->matrix();
  for (int r = 0; r < 4; ++r)
    for (int c = 0; c < 4; ++c) rows.push_back(m(r, c));
  return rows;
}

Result<void> write_events(const Simulation& simulation, const fs::path& file) {
  ordered_json events = ordered_json::array();
  for (const ScriptedEvent& e : simulation.events())
    events.push_back({{"view", e.view},
                      {"kind", to_string(e.kind)},
                      {"object", e.object},
                      {"instance", e.instance},
                      {"known", e.known},
                      {"world_from_object_before", pose_json(e.world_from_object_before)},
                      {"world_from_object_after", pose_json(e.world_from_object_after)}});
  ordered_json objects = ordered_json::object();
  for (std::size_t i = 0; i < simulation.library().size(); ++i) objects[simulation.library()[i].name] = i + 1;
  const ordered_json json{{"scene", simulation.script().name},
                          {"num_views", simulation.num_views()},
                          {"obj_ids", objects},
                          {"events", events}};
  return write_file(file, to_json_text(json, kIndentedJson) + "\n");
}

void report(const WriteSimulationOptions& options, const std::string& what) {
  if (options.progress) options.progress(what);
}

Result<void> write_tuw_models(const std::vector<ProceduralObject>& library, const fs::path& directory,
                              const WriteSimulationOptions& options) {
  int id = 0;
  for (const ProceduralObject& object : library) {
    const std::vector<TrainingView> views = render_turntable(object.mesh, options.turntable);
    const PointCloud surface = sample_visible_surface(object.mesh, options.surface_spacing_m);
    if (auto done = write_tuw_model(directory, object.name, views, &surface, object.symmetries, ++id); !done)
      return done;
    report(options, "model " + object.name);
  }
  return {};
}

Result<void> write_bop_meshes(const std::vector<ProceduralObject>& objects, const fs::path& dataset,
                              const WriteSimulationOptions& options) {
  if (objects.empty()) return {};  // no folder
  auto writer = BopModelsWriter::create(dataset);
  if (!writer) return writer.error();
  int id = 0;
  for (const ProceduralObject& object : objects) {
    ModelSource source;
    source.name = object.name;
    source.bop_id = ++id;
    source.mesh = object.mesh;
    source.symmetries = object.symmetries;
    if (auto done = (*writer)->write_model(source, id); !done) return done;
    report(options, "model " + object.name);
  }
  return (*writer)->finish();
}

Result<void> write_models(const std::vector<ProceduralObject>& library, const fs::path& dataset, DatasetFormat format,
                          const WriteSimulationOptions& options) {
  return format == DatasetFormat::kTuw ? write_tuw_models(library, dataset / "models", options)
                                       : write_bop_meshes(library, dataset, options);
}

// Always in BOP format.
Result<void> write_unknown_models(const std::vector<ProceduralObject>& objects, const fs::path& dataset) {
  return write_bop_meshes(objects, dataset / "unknown", {});
}

std::string scene_folder(const Simulation& simulation, DatasetFormat format, int bop_scene_id) {
  if (format == DatasetFormat::kTuw) return simulation.script().name;
  char name[16];
  std::snprintf(name, sizeof name, "%06d", bop_scene_id);
  return name;
}

}  // namespace

void ChangeChainCollector::add(const Simulation& simulation, int view, const SimulatedView& rendered) {
  for (std::size_t i = 0; i < rendered.ground_truth.size(); ++i) {
    const int instance = rendered.ground_truth_instances[i];
    const int placement = simulation.placement_number(instance, view);
    auto chain = std::ranges::find_if(
        open_, [&](const OpenChain& c) { return c.instance == instance && c.placement == placement; });
    if (chain == open_.end()) chain = open_.insert(open_.end(), OpenChain{instance, placement, {}});
    const GroundTruthObject& truth = rendered.ground_truth[i];
    chain->chain.entries.push_back({rendered.frame.name, view, truth.object, truth.instance});
  }
}

std::vector<ChangeChain> ChangeChainCollector::chains() const {
  std::vector<ChangeChain> chains;
  for (const OpenChain& c : open_) chains.push_back(c.chain);
  return chains;
}

namespace {

// Writes test/<scene>/ and test/<scene>.changes.
Result<void> write_scene(Simulation& simulation, const fs::path& dataset, const std::string& scene,
                         DatasetFormat format, const WriteSimulationOptions& options) {
  auto writer = create_sequence(dataset / "test" / scene, format);
  if (!writer) return writer.error();
  ChangeChainCollector chains;
  for (int view = 0; view < simulation.num_views(); ++view) {
    const SimulatedView rendered = simulation.render_view(view);
    chains.add(simulation, view, rendered);
    if (auto done = (*writer)->write_view(rendered.frame, rendered.ground_truth); !done) return done;
    report(options, scene + " view " + std::to_string(view + 1) + "/" + std::to_string(simulation.num_views()));
  }
  if (auto done = (*writer)->finish(); !done) return done;
  return write_changes(dataset / "test" / (scene + ".changes"), chains.chains());
}

bool have_one_library(const Simulation& a, const std::vector<std::string>& names) {
  std::vector<std::string> own;
  for (const ProceduralObject& object : a.library()) own.push_back(object.name);
  return own == names;
}

}  // namespace

Result<void> write_simulation(Simulation& simulation, const fs::path& directory, DatasetFormat format,
                              const WriteSimulationOptions& options) {
  auto pending = PendingDirectory::create(directory);
  if (!pending) return pending.error();
  if (options.models) {
    if (auto done = write_models(simulation.library(), pending->path(), format, options); !done) return done;
    if (auto done = write_unknown_models(simulation.unknown_objects(), pending->path()); !done) return done;
  }
  const std::string scene = scene_folder(simulation, format, options.bop_scene_id);
  if (auto done = write_scene(simulation, pending->path(), scene, format, options); !done) return done;
  if (auto done = write_events(simulation, pending->path() / "events.json"); !done) return done;
  return pending->commit();
}

Result<void> write_simulations(std::span<const SceneScript> scripts, std::uint64_t seed, const fs::path& directory,
                               DatasetFormat format, const SimulationOptions& simulation_options,
                               const WriteSimulationOptions& options) {
  require(!scripts.empty(), "write_simulations: there is no scene");
  auto pending = PendingDirectory::create(directory);
  if (!pending) return pending.error();
  std::vector<std::string> library;
  std::map<std::string, ProceduralObject> unknown;
  for (std::size_t i = 0; i < scripts.size(); ++i) {
    auto simulation = Simulation::create(scripts[i], Rng::stream(seed, i).next(), simulation_options);
    if (!simulation) return simulation.error();
    if (i == 0) {
      for (const ProceduralObject& object : simulation->library()) library.push_back(object.name);
      if (options.models)
        if (auto done = write_models(simulation->library(), pending->path(), format, options); !done) return done;
    }
    require(have_one_library(*simulation, library),
            "write_simulations: scene '" + scripts[i].name + "' has other known objects than the first scene");
    for (const ProceduralObject& object : simulation->unknown_objects()) unknown.try_emplace(object.name, object);
    const std::string scene = scene_folder(*simulation, format, static_cast<int>(i) + 1);
    if (auto done = write_scene(*simulation, pending->path(), scene, format, options); !done) return done;
    if (auto done = write_events(*simulation, pending->path() / "test" / (scene + ".events.json")); !done) return done;
  }
  std::vector<ProceduralObject> unknown_objects;
  for (auto& [name, object] : unknown) unknown_objects.push_back(std::move(object));
  if (options.models)
    if (auto done = write_unknown_models(unknown_objects, pending->path()); !done) return done;
  if (options.write_more)
    if (auto done = options.write_more(pending->path()); !done) return done;
  return pending->commit();
}

}  // namespace resight
