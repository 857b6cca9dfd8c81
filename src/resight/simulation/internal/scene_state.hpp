// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <memory>
#include <optional>
#include <vector>

#include "resight/core/result.hpp"
#include "resight/geometry/triangle_mesh.hpp"
#include "resight/simulation/simulation.hpp"

namespace resight {

/// A script turned into meshes and poses: everything about a run that needs no rendering.
struct SceneState {
  SceneScript script;
  std::vector<SimulatedInstance> instances;  ///< Room, furniture, then objects, in the order of the script.
  std::vector<std::shared_ptr<const TriangleMesh>> meshes;  ///< Of each instance; shared between equal models.
  std::vector<ProceduralObject> library;
  std::vector<ScriptedEvent> events;
  std::vector<std::vector<std::optional<Rigid3>>>
      poses;                                 ///< [view][instance], world_from_instance; absent = not there.
  std::vector<std::vector<int>> placements;  ///< [view][instance]: number of the placement, from 0.
};

[[nodiscard]] Result<SceneState> build_scene_state(SceneScript script, std::uint64_t seed);

}  // namespace resight
