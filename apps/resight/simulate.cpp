// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include "commands.hpp"
#include "progress.hpp"
#include "resight/simulation/presets.hpp"
#include "resight/simulation/simulation.hpp"
#include "resight/simulation/write_simulation.hpp"

namespace resight::app {

void run_simulate(const SimulateArguments& arguments) {
  if (arguments.preset.empty() && arguments.script.empty())
    throw InputError("simulate: neither a scene script nor --preset was given");
  SceneScript script = value_or_throw(arguments.preset.empty() ? read_scene_script(arguments.script)
                                                               : make_preset_scene(arguments.preset, arguments.seed));
  script.sensor.noise_free = script.sensor.noise_free || arguments.noise_free;
  Simulation simulation =
      value_or_throw(Simulation::create(std::move(script), arguments.seed, {.num_threads = arguments.num_threads}));
  const bool is_bop = arguments.format == "bop";
  // Models come first, then the views.
  const int num_models = static_cast<int>(simulation.library().size());
  {
    Progress progress("simulate", num_models + simulation.num_views());
    int done = 0;
    WriteSimulationOptions options;
    options.turntable.num_threads = arguments.num_threads;
    options.progress = [&](const std::string& what) { progress.report(++done, what); };
    value_or_throw(
        write_simulation(simulation, arguments.out, is_bop ? DatasetFormat::kBop : DatasetFormat::kTuw, options));
  }
  fmt::print("{} objects, {} views, {} changes: {}\n", num_models, simulation.num_views(), simulation.events().size(),
             arguments.out.string());
}

}  // namespace resight::app
