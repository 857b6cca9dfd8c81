// SPDX-License-Identifier: Apache-2.0
#include "resight/simulation/tabletop_library.hpp"

#include <algorithm>
#include <array>

#include "resight/core/files.hpp"
#include "resight/core/random.hpp"
#include "resight/io/bop_models.hpp"
#include "resight/simulation/baked_light.hpp"
#include "resight/simulation/realistic_recording.hpp"
#include "resight/simulation/seeded_objects.hpp"

namespace resight {
namespace {

constexpr std::uint64_t kScanStream = 3000;
constexpr std::uint64_t kRecordingStream = 4000;
constexpr double kRecordingStep_deg = 12;
// Positions in SeededObjectNames::known: one twin of each pair, boxes, a flat package, a carton, cans, a bottle, a cup,
// a figure and the toys. Books are not: they lie too flat on a turntable for `resight model` (39 % of one was
// complete).
constexpr std::array<std::size_t, 14> kRecorded{0, 2, 4, 6, 10, 11, 13, 14, 15, 18, 23, 25, 26, 27};

}  // namespace

std::string_view to_string(ModelOrigin origin) {
  switch (origin) {
    case ModelOrigin::kMesh:
      return "mesh";
    case ModelOrigin::kScan:
      return "scan";
    case ModelOrigin::kRecording:
      return "recording";
  }
  return "";
}

std::vector<TabletopModel> tabletop_models(std::uint64_t seed) {
  const std::vector<std::string> names = seeded_object_names(seed).known;
  std::vector<TabletopModel> models;
  bool scanned = false;
  for (std::size_t i = 0; i < names.size(); ++i) {
    TabletopModel model{names[i], 0, ModelOrigin::kRecording};
    if (std::ranges::find(kRecorded, i) == kRecorded.end()) {
      model.origin = scanned ? ModelOrigin::kScan : ModelOrigin::kMesh;
      scanned = !scanned;
    }
    models.push_back(model);
  }
  std::ranges::sort(models, {}, &TabletopModel::name);
  for (std::size_t i = 0; i < models.size(); ++i) models[i].bop_id = static_cast<int>(i) + 1;
  return models;
}

Result<void> write_tabletop_meshes(std::uint64_t seed, const std::filesystem::path& dataset,
                                   const std::function<void(const std::string&)>& progress) {
  auto writer = BopModelsWriter::create(dataset);
  if (!writer) return writer.error();
  for (const TabletopModel& model : tabletop_models(seed)) {
    if (model.origin == ModelOrigin::kRecording) continue;
    const ProceduralObject object = *make_seeded_object(seed, model.name);
    ModelSource source;
    source.name = model.name;
    source.bop_id = model.bop_id;
    source.mesh =
        model.origin == ModelOrigin::kScan
            ? bake_light(object, Rng::stream(seed, kScanStream + static_cast<std::uint64_t>(model.bop_id)).next())
            : object.mesh;
    source.symmetries = object.symmetries;
    if (auto done = (*writer)->write_model(source, model.bop_id); !done) return done;
    if (progress) progress(std::string(to_string(model.origin)) + " " + model.name);
  }
  return (*writer)->finish();
}

RecordingOptions tabletop_recording_options(std::uint64_t seed, const TabletopModel& model) {
  Rng rng = Rng::stream(seed, kRecordingStream);
  RecordingOptions options;
  options.step_deg = kRecordingStep_deg;
  options.sensor = draw_sensor(rng);
  options.sensor.min_depth_m = 0.4;
  options.lighting = draw_lighting(rng);
  options.seed = Rng::stream(seed, kRecordingStream + static_cast<std::uint64_t>(model.bop_id)).next();
  return options;
}

Result<void> write_tabletop_recordings(std::uint64_t seed, const std::filesystem::path& directory, DatasetFormat format,
                                       int num_threads, const std::function<void(const std::string&)>& progress) {
  auto pending = PendingDirectory::create(directory);
  if (!pending) return pending.error();
  for (const TabletopModel& model : tabletop_models(seed)) {
    if (model.origin != ModelOrigin::kRecording) continue;
    RecordingOptions options = tabletop_recording_options(seed, model);
    options.num_threads = num_threads;
    const auto report = [&](const std::string& side) {
      if (progress) progress(model.name + " " + side);
    };
    const ProceduralObject object = *make_seeded_object(seed, model.name);
    if (auto done = write_recordings(object, pending->path() / model.name, format, options, report); !done) return done;
  }
  return pending->commit();
}

}  // namespace resight
