// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "resight/io/sequence.hpp"
#include "resight/io/tuw_changes.hpp"
#include "resight/rendering/turntable.hpp"
#include "resight/simulation/simulation.hpp"

namespace resight {

/// Collects the `.changes` chains of a simulation: one chain per instance and placement, over the views that annotate
/// it.
class ChangeChainCollector {
 public:
  /// Views must be added in order.
  void add(const Simulation& simulation, int view, const SimulatedView& rendered);
  /// The chains of all views added so far.
  [[nodiscard]] std::vector<ChangeChain> chains() const;

 private:
  struct OpenChain {
    int instance = 0;
    int placement = 0;
    ChangeChain chain;
  };
  std::vector<OpenChain> open_;
};

struct WriteSimulationOptions {
  bool models = true;          ///< Also write the models, of known and unknown objects.
  TurntableOptions turntable;  ///< Of the training views (TUW only).
  double surface_spacing_m = 0.002;
  int bop_scene_id = 1;
  /// Writes more files into the folder of write_simulations() before it appears.
  std::function<Result<void>(const std::filesystem::path&)> write_more = {};
  /// Called after each model and view with what was done, e.g. for a progress line.
  std::function<void(const std::string&)> progress;
};

/// Renders all views of a simulation and writes a data set to `directory`, which must be missing or empty. The folder
/// appears when it is complete.
///
/// TUW: models/<name>/ (training views of a turntable, 3D_model.pcd), test/<scene>/ (views and ground truth). BOP:
/// models/obj_%06d.ply with models_info.json, test/%06d/. Both: test/<scene>.changes (chains of placements, as in TUW)
/// and events.json (all changes with poses as 4x4 matrices in row-major order, metres, world frame). Meshes of objects
/// that are in no library, if there are any, are written to unknown/models/ (always in BOP format), for evaluations of
/// their changes.
[[nodiscard]] Result<void> write_simulation(Simulation& simulation, const std::filesystem::path& directory,
                                            DatasetFormat format, const WriteSimulationOptions& options = {});

/// Same for several scenes with one library (the same known objects) as one data set. The scenes are test/000001,
/// test/000002, ... (BOP) or test/<name of the scene> (TUW); their changes are test/<scene>.changes and
/// test/<scene>.events.json. Scene i uses the i-th random stream of `seed`. `progress` is called after each model and
/// view.
[[nodiscard]] Result<void> write_simulations(std::span<const SceneScript> scripts, std::uint64_t seed,
                                             const std::filesystem::path& directory, DatasetFormat format,
                                             const SimulationOptions& simulation,
                                             const WriteSimulationOptions& options = {});

}  // namespace resight
