// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <vector>

#include "resight/annotation/annotation_document.hpp"
#include "resight/geometry/mesh_sampling.hpp"
#include "resight/models/object_model.hpp"
#include "resight/sensor/sequence.hpp"
#include "resight/simulation/scene_script.hpp"
#include "resight/simulation/simulation.hpp"

namespace resight::test {

/// A simulated scene in which one object moves and one is removed, with its exact annotation.
class AnnotatedScene : public Sequence {
 public:
  static constexpr const char* kScript = R"(
name = "annotated"
[camera]
width = 320
height = 240
fx = 262.5
fy = 262.5
cx = 159.5
cy = 119.5
[camera.orbit]
center_m = [0.0, 0.0, 0.80]
radius_m = 0.6
height_m = 0.35
start_deg = -110
end_deg = -60
views = 6
[[furniture]]
key = "table"
kind = "table"
size_m = [1.0, 0.7, 0.74]
[[object]]
model = "cereal_blue"
on = "table"
x_m = -0.12
yaw_deg = 20
[[object]]
model = "tea_box"
on = "table"
x_m = 0.15
yaw_deg = 35
[[change]]
view = 3
kind = "move"
object = "cereal_blue"
on = "table"
x_m = -0.05
y_m = 0.12
yaw_deg = 50
[[change]]
view = 4
kind = "remove"
object = "tea_box"
)";

  AnnotatedScene() {
    const std::string file = "/tmp/resight_annotated_" + std::to_string(::getpid()) + ".toml";
    std::ofstream(file) << kScript;
    auto simulation = Simulation::create(*read_scene_script(file), 1);
    std::filesystem::remove(file);
    for (int v = 0; v < simulation->num_views(); ++v) {
      SimulatedView view = simulation->render_view(v);
      frames.push_back(std::move(view.frame));
      truth.push_back(std::move(view.ground_truth));
    }
    library.surface_voxel_m = 0.003F;
    for (const ProceduralObject& object : simulation->library()) {
      ObjectModel model;
      model.name = object.name;
      model.bop_id = static_cast<int>(library.objects.size()) + 1;
      model.surface = voxel_downsample(sample_surface(object.mesh, 1e6), 0.003);
      model.symmetries = object.symmetries;
      model.center = centroid(model.surface.points);
      model.diameter_m = diameter(model.surface.points);
      library.objects.push_back(std::move(model));
    }
    annotate(*simulation);
  }

  [[nodiscard]] std::string format() const override { return "test"; }
  [[nodiscard]] int num_views() const override { return static_cast<int>(frames.size()); }
  [[nodiscard]] std::string view_name(int view) const override { return frames[static_cast<std::size_t>(view)].name; }
  [[nodiscard]] Result<RgbdFrame> read_view(int view) const override { return frames[static_cast<std::size_t>(view)]; }

  std::vector<RgbdFrame> frames;
  std::vector<std::vector<GroundTruthObject>> truth;
  ModelLibrary library;
  AnnotationDocument document;

 private:
  void annotate(const Simulation& simulation) {
    for (std::size_t i = 0; i < simulation.instances().size(); ++i) {
      const SimulatedInstance& instance = simulation.instances()[i];
      if (instance.object < 0) continue;
      int placement = -1;
      for (int v = 0; v < num_views(); ++v) {
        const auto& pose = simulation.world_from_instance(static_cast<int>(i), v);
        if (!pose) continue;
        const int number = simulation.placement_number(static_cast<int>(i), v);
        if (number != placement) {
          const int id = document.next_id++;
          document.objects[id] = {.id = id,
                                  .track = static_cast<int>(i),
                                  .object = instance.object,
                                  .first_view = v,
                                  .last_view = v,
                                  .world_from_object = *pose};
          placement = number;
        }
        document.objects.rbegin()->second.last_view = v;
      }
    }
  }
};

}  // namespace resight::test
