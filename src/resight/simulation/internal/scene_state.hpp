// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <memory>
#include <optional>
#include <vector>

#include "resight/core/result.hpp"
#include "resight/geometry/triangle_mesh.hpp"
#include "resight/simulation/simulation.hpp"

namespace resight {

/// Meshes and poses of a script: all of a simulation that needs no rendering.
struct SceneState {
  SceneScript script;
  std::vector<SimulatedInstance> instances;  ///< Room, furniture, then objects, in the order of the script.
  std::vector<std::shared_ptr<const TriangleMesh>> meshes;  ///< Mesh of each instance; shared between equal models.
  std::vector<SurfaceMaterial> materials;                   ///< Of each instance.
  std::vector<ProceduralObject> library;
  std::vector<ProceduralObject> unknown_objects;  ///< Models of the distractors.
  std::vector<ScriptedEvent> events;
  /// [view][instance], world_from_instance; absent if the instance is not in the scene.
  std::vector<std::vector<std::optional<Rigid3>>> poses;
  std::vector<std::vector<int>> placements;  ///< [view][instance]: number of the placement, from 0.
};

/// Builds the state. Fails if the script is invalid or a mesh cannot be read.
[[nodiscard]] Result<SceneState> build_scene_state(SceneScript script, std::uint64_t seed);

}  // namespace resight
