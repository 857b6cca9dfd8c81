// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "resight/core/result.hpp"
#include "resight/io/sequence.hpp"
#include "resight/simulation/recording.hpp"

namespace resight {

/// How users get the model of an object.
enum class ModelOrigin : std::uint8_t {
  kMesh,       ///< A clean textured mesh.
  kScan,       ///< A mesh whose texture carries the light of the place where it was scanned.
  kRecording,  ///< `resight model` makes it from recordings with a depth camera.
};
[[nodiscard]] std::string_view to_string(ModelOrigin origin);

/// A known object of dynamic-tabletop version 3.
struct TabletopModel {
  std::string name;
  int bop_id = 0;
  ModelOrigin origin = ModelOrigin::kMesh;
};
/// The known objects of a seed in order of bop_id. Half are recorded; of the others, half are scans. Objects that
/// cannot be recorded are never so: without texture, or without depth.
[[nodiscard]] std::vector<TabletopModel> tabletop_models(std::uint64_t seed);

/// Writes the meshes and scans of a seed as `dataset`/models (BOP), for training. `progress` is called after each.
[[nodiscard]] Result<void> write_tabletop_meshes(std::uint64_t seed, const std::filesystem::path& dataset,
                                                 const std::function<void(const std::string&)>& progress = {});

/// How a recorded object is recorded: all in one room with one device, as a user would.
[[nodiscard]] RecordingOptions tabletop_recording_options(std::uint64_t seed, const TabletopModel& model);

/// Writes `directory`/<name>/side_1 and side_2 for each recorded object (write_recordings()). The folder appears
/// when it is complete.
[[nodiscard]] Result<void> write_tabletop_recordings(std::uint64_t seed, const std::filesystem::path& directory,
                                                     DatasetFormat format, int num_threads = 1,
                                                     const std::function<void(const std::string&)>& progress = {});

}  // namespace resight
