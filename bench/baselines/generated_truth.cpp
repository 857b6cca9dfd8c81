// SPDX-License-Identifier: Apache-2.0
#include "generated_truth.hpp"

#include <algorithm>

#include "../quality/arguments.hpp"
#include "resight/rendering/raycast_scene.hpp"
#include "resight/rendering/view_renderer.hpp"
#include "resight/simulation/room.hpp"

namespace resight::bench {
namespace {

using Role = SimulatedInstance::Role;

// The seed of the room does not affect its shape.
TriangleMesh mesh_of(const SceneScript& script, const SimulatedInstance& instance) {
  if (instance.role == Role::kRoom) return make_room(*script.room_size_m, 1);
  if (instance.role == Role::kFurniture) {
    const auto of_key = [&](const FurnitureScript& f) { return f.key == instance.key; };
    const auto furniture = std::ranges::find_if(script.furniture, of_key);
    return value_or_exit(make_furniture(furniture->kind, furniture->size_m, 1)).mesh;
  }
  return value_or_exit(instance.role == Role::kKnown ? make_procedural_object(instance.model)
                                                     : make_distractor(instance.model))
      .mesh;
}

Image<Eigen::Vector3f> cast_normals(const Simulation& simulation, int view) {
  RaycastScene scene;
  for (std::size_t i = 0; i < simulation.instances().size(); ++i)
    if (const auto& pose = simulation.world_from_instance(static_cast<int>(i), view))
      scene.add_instance(scene.add_mesh(mesh_of(simulation.script(), simulation.instances()[i])), *pose);
  scene.commit();
  const SceneScript& script = simulation.script();
  RenderOptions options;
  options.samples_per_side = 1;
  return render_scene(scene, script.camera, script.world_from_camera[static_cast<std::size_t>(view)], options)
      .normals_in_camera;
}

}  // namespace

ViewTruth truth_of_view(const Simulation& simulation, const SimulatedView& rendered, int view, int other) {
  const Image<int>& labels = rendered.labels;
  ViewTruth truth;
  truth.normals_in_camera = cast_normals(simulation, view);
  truth.is_thing = Image<std::uint8_t>(labels.width(), labels.height());
  truth.is_changed = truth.is_thing;
  for (std::size_t i = 0; i < labels.size(); ++i) {
    if (labels[i] < 0) continue;
    const Role role = simulation.instances()[static_cast<std::size_t>(labels[i])].role;
    const bool is_moved =
        simulation.placement_number(labels[i], view) != simulation.placement_number(labels[i], other) ||
        !simulation.world_from_instance(labels[i], other);
    truth.is_thing[i] = role == Role::kKnown || role == Role::kDistractor ? 1 : 0;
    truth.is_changed[i] = is_moved ? 1 : 0;
  }
  return truth;
}

}  // namespace resight::bench
