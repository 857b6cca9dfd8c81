// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <memory>
#include <string>
#include <vector>

#include "resight/io/sequence.hpp"
#include "resight/simulation/procedural_objects.hpp"
#include "resight/simulation/scene_script.hpp"

namespace resight {

/// What has happened before a view was seen.
struct ScriptedEvent {
  int view = 0;
  ChangeKind kind = ChangeKind::kMoved;
  std::string object;                              ///< Name of the model.
  std::string instance;                            ///< Key in the script.
  bool known = true;                               ///< False for distractors.
  std::optional<Rigid3> world_from_object_before;  ///< Absent for kAdded.
  std::optional<Rigid3> world_from_object_after;   ///< Absent for kRemoved.
};

/// One view of the run, as a sensor delivers it, and the truth about it.
struct SimulatedView {
  RgbdFrame frame;
  /// The known objects whose silhouette touches the image, hidden or not, in the order of the script. visible_share is
  /// BOP's visib_fract: visible pixels over the pixels of the object rendered alone, those beyond the image border
  /// included.
  std::vector<GroundTruthObject> ground_truth;
  std::vector<int> ground_truth_instances;  ///< Index into Simulation::instances() of each.
  Image<int> labels;  ///< Index into Simulation::instances() of what each pixel's centre sees; -1 = nothing.
  std::vector<ScriptedEvent> events;  ///< Those that happened just before this view.
};

/// A thing of the scene: known object, distractor or furniture.
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

/// A scripted scene that can be looked at view by view. Views may be rendered in any order, each any number of times:
/// the same bytes for the same script and seed, whatever the number of threads. One call at a time.
class Simulation {
 public:
  /// Builds all meshes. The error names what of the script is wrong, or the mesh file that cannot be read.
  [[nodiscard]] static Result<Simulation> create(SceneScript script, std::uint64_t seed,
                                                 const SimulationOptions& options = {});
  ~Simulation();
  Simulation(Simulation&&) noexcept;
  Simulation& operator=(Simulation&&) noexcept;

  [[nodiscard]] const SceneScript& script() const;
  [[nodiscard]] int num_views() const;
  [[nodiscard]] const std::vector<SimulatedInstance>& instances() const;
  /// The known objects of the script, each once, in order of name; bop_id = index + 1.
  [[nodiscard]] const std::vector<ProceduralObject>& library() const;
  /// All events, in order.
  [[nodiscard]] const std::vector<ScriptedEvent>& events() const;
  /// Where an instance is during a view; absent = it is not there.
  [[nodiscard]] const std::optional<Rigid3>& world_from_instance(int instance, int view) const;
  /// Number that grows each time the instance is put anywhere: one chain of `.changes` per instance and placement.
  [[nodiscard]] int placement_number(int instance, int view) const;

  [[nodiscard]] SimulatedView render_view(int view);

 private:
  struct Impl;
  explicit Simulation(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace resight
