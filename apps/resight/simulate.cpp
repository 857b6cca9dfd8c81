// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include "commands.hpp"
#include "progress.hpp"
#include "resight/simulation/dynamic_tabletop.hpp"
#include "resight/simulation/presets.hpp"
#include "resight/simulation/simulation.hpp"
#include "resight/simulation/write_simulation.hpp"

namespace resight::app {
namespace {

constexpr const char* kBenchmark = "dynamic-tabletop";

DatasetFormat to_format(const std::string& name) { return name == "bop" ? DatasetFormat::kBop : DatasetFormat::kTuw; }

WriteSimulationOptions write_options(const SimulateArguments& arguments, Progress& progress) {
  WriteSimulationOptions options;
  options.turntable.num_threads = arguments.num_threads;
  options.progress = [&progress, done = 0](const std::string& what) mutable { progress.report(++done, what); };
  return options;
}

void simulate_scene(const SimulateArguments& arguments) {
  SceneScript script = value_or_throw(arguments.preset.empty() ? read_scene_script(arguments.script)
                                                               : make_preset_scene(arguments.preset, arguments.seed));
  script.sensor.noise_free = script.sensor.noise_free || arguments.noise_free;
  Simulation simulation =
      value_or_throw(Simulation::create(std::move(script), arguments.seed, {.num_threads = arguments.num_threads}));
  // Models come first, then the views.
  const int num_models = static_cast<int>(simulation.library().size());
  {
    Progress progress("simulate", num_models + simulation.num_views());
    value_or_throw(
        write_simulation(simulation, arguments.out, to_format(arguments.format), write_options(arguments, progress)));
  }
  fmt::print("{} objects, {} views, {} changes: {}\n", num_models, simulation.num_views(), simulation.events().size(),
             arguments.out.string());
}

void simulate_benchmark(const SimulateArguments& arguments) {
  std::vector<SceneScript> scripts = make_dynamic_tabletop(arguments.seed);
  const std::size_t num_models = dynamic_tabletop_library().size();
  std::size_t num_views = 0;
  std::size_t num_changes = 0;
  for (SceneScript& script : scripts) {
    script.sensor.noise_free = arguments.noise_free;
    num_views += script.world_from_camera.size();
    num_changes += script.changes.size();
  }
  {
    Progress progress("simulate", static_cast<int>(num_models + num_views));
    value_or_throw(write_simulations(scripts, arguments.seed, arguments.out, to_format(arguments.format),
                                     {.num_threads = arguments.num_threads}, write_options(arguments, progress)));
  }
  fmt::print("{} version {}, seed {}: {} sequences, {} objects, {} views, {} changes: {}\n", kBenchmark,
             kDynamicTabletopVersion, arguments.seed, scripts.size(), num_models, num_views, num_changes,
             arguments.out.string());
}

}  // namespace

void run_simulate(const SimulateArguments& arguments) {
  if (arguments.preset.empty() && arguments.script.empty())
    throw InputError("simulate: neither a scene script nor --preset was given");
  if (arguments.preset == kBenchmark) return simulate_benchmark(arguments);
  simulate_scene(arguments);
}

}  // namespace resight::app
