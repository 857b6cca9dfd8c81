// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "commands.hpp"
#include "output_paths.hpp"
#include "progress.hpp"
#include "resight/simulation/dynamic_tabletop.hpp"
#include "resight/simulation/presets.hpp"
#include "resight/simulation/recording.hpp"
#include "resight/simulation/simulation.hpp"
#include "resight/simulation/tabletop_library.hpp"
#include "resight/simulation/write_simulation.hpp"

namespace resight::app {
namespace {

constexpr const char* kBenchmark = "dynamic-tabletop";
constexpr const char* kBenchmark2 = "dynamic-tabletop-2";
constexpr const char* kBenchmarkRecordings = "dynamic-tabletop-recordings";
constexpr const char* kTurntableRecording = "turntable-recording";
constexpr const char* kWalkRecording = "walk-recording";
constexpr const char* kRecordedObject = "milk_carton";

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
  // Models are written first, then the views.
  const int num_models = static_cast<int>(simulation.library().size());
  {
    Progress progress("simulate", num_models + simulation.num_views());
    value_or_throw(
        write_simulation(simulation, arguments.out, to_format(arguments.format), write_options(arguments, progress)));
  }
  print("{} objects, {} views, {} changes: {}\n", num_models, simulation.num_views(), simulation.events().size(),
        shown_output(arguments));
}

void simulate_benchmark(const SimulateArguments& arguments) {
  const auto benchmark =
      DynamicTabletopOptions::of_version(arguments.preset == kBenchmark2 ? 2 : kDynamicTabletopVersion);
  std::vector<SceneScript> scripts = make_dynamic_tabletop(arguments.seed, benchmark);
  const std::size_t num_models = dynamic_tabletop_library(arguments.seed, benchmark.version).size();
  std::size_t num_views = 0;
  std::size_t num_changes = 0;
  for (SceneScript& script : scripts) {
    script.sensor.noise_free = arguments.noise_free;
    num_views += script.world_from_camera.size();
    num_changes += script.changes.size();
  }
  {
    Progress progress("simulate", static_cast<int>(num_models + num_views));
    WriteSimulationOptions options = write_options(arguments, progress);
    if (benchmark.version >= 3)
      options.write_more = [&](const std::filesystem::path& folder) {
        return write_tabletop_meshes(arguments.seed, folder / "library");
      };
    value_or_throw(write_simulations(scripts, arguments.seed, arguments.out, to_format(arguments.format),
                                     {.num_threads = arguments.num_threads}, options));
  }
  print("{} version {}, seed {}: {} sequences, {} objects, {} views, {} changes: {}\n", kBenchmark, benchmark.version,
        arguments.seed, scripts.size(), num_models, num_views, num_changes, shown_output(arguments));
}

void simulate_recordings(const SimulateArguments& arguments) {
  const ProceduralObject object =
      value_or_throw(make_procedural_object(arguments.object.empty() ? kRecordedObject : arguments.object));
  RecordingOptions options;
  options.kind = arguments.preset == kWalkRecording ? RecordingKind::kWalk : RecordingKind::kTurntable;
  options.sensor.noise_free = arguments.noise_free;
  options.seed = arguments.seed;
  options.num_threads = arguments.num_threads;
  {
    Progress progress("simulate", 2);
    value_or_throw(
        write_recordings(object, arguments.out, to_format(arguments.format), options,
                         [&progress, done = 0](const std::string& what) mutable { progress.report(++done, what); }));
  }
  print("{} of {}, seed {}: {}/side_1, side_2\n", arguments.preset, object.name, arguments.seed,
        shown_output(arguments));
}

void simulate_benchmark_recordings(const SimulateArguments& arguments) {
  const std::vector<TabletopModel> models = tabletop_models(arguments.seed);
  const auto num_recorded = std::ranges::count(models, ModelOrigin::kRecording, &TabletopModel::origin);
  {
    Progress progress("simulate", 2 * static_cast<int>(num_recorded));
    value_or_throw(write_tabletop_recordings(
        arguments.seed, arguments.out, to_format(arguments.format), arguments.num_threads,
        [&progress, done = 0](const std::string& what) mutable { progress.report(++done, what); }));
  }
  print("{} version {}, seed {}: recordings of {} objects: {}\n", kBenchmark, kDynamicTabletopVersion, arguments.seed,
        num_recorded, shown_output(arguments));
}

bool is_recording(const std::string& preset) { return preset == kTurntableRecording || preset == kWalkRecording; }

}  // namespace

void run_simulate(const SimulateArguments& arguments) {
  if (arguments.preset.empty() && arguments.script.empty())
    throw InputError("simulate: neither a scene script nor --preset was given");
  if (!arguments.object.empty() && !is_recording(arguments.preset))
    throw InputError("simulate: --object requires --preset turntable-recording or walk-recording");
  if (arguments.noise_free && arguments.preset == kBenchmarkRecordings)
    throw InputError(fmt::format("simulate: --noise-free does not apply to --preset {}", kBenchmarkRecordings));
  check_new_folder(arguments.out);
  if (is_recording(arguments.preset)) return simulate_recordings(arguments);
  if (arguments.preset == kBenchmark || arguments.preset == kBenchmark2) return simulate_benchmark(arguments);
  if (arguments.preset == kBenchmarkRecordings) return simulate_benchmark_recordings(arguments);
  simulate_scene(arguments);
}

}  // namespace resight::app
