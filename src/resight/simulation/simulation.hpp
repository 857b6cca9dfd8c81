// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <memory>
#include <string>
#include <vector>

#include "resight/sensor/sequence.hpp"
#include "resight/simulation/procedural_objects.hpp"
#include "resight/simulation/scene_script.hpp"

namespace resight {

/// A change that occurred before a view.
struct ScriptedEvent {
  int view = 0;
  ChangeKind kind = ChangeKind::kMoved;
  std::string object;                              ///< Name of the model.
  std::string instance;                            ///< Key in the script.
  bool known = true;                               ///< False for distractors.
  std::optional<Rigid3> world_from_object_before;  ///< Absent for kAdded.
  std::optional<Rigid3> world_from_object_after;   ///< Absent for kRemoved.
};

/// One view of the simulation as a sensor delivers it, with its ground truth.
struct SimulatedView {
  RgbdFrame frame;  ///< Its pose is the reported one; ground truth refers to the true camera.
  /// The known objects whose silhouettes touch the image, hidden or not, in the order of the script. visible_share is
  /// visib_fract of BOP: visible pixels divided by the pixels of the object rendered alone, including those outside the
  /// image.
  std::vector<GroundTruthObject> ground_truth;
  std::vector<int> ground_truth_instances;  ///< Index into Simulation::instances() of each object.
  Image<int> labels;  ///< Index into Simulation::instances() of the thing at the centre of each pixel; -1 = nothing.
  std::vector<ScriptedEvent> events;  ///< Events between the previous view and this one.
};

/// A part of the scene: known object, distractor, furniture or room.
struct SimulatedInstance {
  enum class Role { kRoom, kFurniture, kDistractor, kKnown };
  std::string key;
  std::string model;
  Role role = Role::kKnown;
  int object = -1;  ///< Index into Simulation::library(); -1 unless known.
};

struct SimulationOptions {
  int samples_per_side = 2;  ///< See RenderOptions.
  int num_threads = 1;
  void check() const;
};

/// A scripted scene that is rendered view by view. Views can be rendered in any order and repeatedly. The same script
/// and seed give the same bytes for any number of threads. Calls must not overlap.
class Simulation {
 public:
  /// Builds all meshes. The error names the mistake in the script, or the mesh file that cannot be read.
  [[nodiscard]] static Result<Simulation> create(SceneScript script, std::uint64_t seed,
                                                 const SimulationOptions& options = {});
  ~Simulation();
  Simulation(Simulation&&) noexcept;
  Simulation& operator=(Simulation&&) noexcept;

  [[nodiscard]] const SceneScript& script() const;
  [[nodiscard]] int num_views() const;
  [[nodiscard]] const std::vector<SimulatedInstance>& instances() const;
  /// The known objects of the script, one entry per model, in order of name; bop_id = index + 1.
  [[nodiscard]] const std::vector<ProceduralObject>& library() const;
  /// The models of the distractors, one entry per model, in order of name.
  [[nodiscard]] const std::vector<ProceduralObject>& unknown_objects() const;
  /// All events, in order.
  [[nodiscard]] const std::vector<ScriptedEvent>& events() const;
  /// Pose of an instance during a view; absent if it is not in the scene.
  [[nodiscard]] const std::optional<Rigid3>& world_from_instance(int instance, int view) const;
  /// A number that increases with each placement of the instance. `.changes` has one chain per instance and placement.
  [[nodiscard]] int placement_number(int instance, int view) const;

  /// Renders a view. Throws std::invalid_argument if it does not exist.
  [[nodiscard]] SimulatedView render_view(int view);

 private:
  struct Impl;
  explicit Simulation(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace resight
