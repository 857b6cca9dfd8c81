// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <string_view>
#include <vector>

#include "resight/core/result.hpp"
#include "resight/simulation/scene_script.hpp"

namespace resight {

/// Makes the scene of `resight demo`: a desk in a room with ten known objects (one untextured, one symmetric), three
/// unknown ones, a monitor and a keyboard. 12 views cover 120 deg at 0.9 to 1.3 m. There are five changes: two objects
/// are moved, one is removed, and one is added and later removed. `seed` shifts and rotates the objects slightly; it
/// does not affect the sensor.
[[nodiscard]] SceneScript make_demo_scene(std::uint64_t seed = 1);

struct RandomTabletopOptions {
  int num_known = 8;
  int num_distractors = 3;
  int num_views = 12;
  int num_changes = 4;          ///< Spread evenly; moves, removals and additions in turn.
  double min_distance_m = 0.9;  ///< Of the camera from the middle of the table top.
  double max_distance_m = 1.3;
  double arc_deg = 120;
  double gap_m = 0.02;              ///< Between the circles around neighbouring objects; less means more occlusion.
  bool lay_down = false;            ///< A third of the objects lies on a side.
  std::vector<std::string> models;  ///< To choose from; empty = all procedural objects.
  void check() const;
};

/// Makes a table in a room with objects at random places that do not overlap, and changes. Equal seeds and options give
/// equal scripts. If the table is full, it has fewer objects than requested (see SceneScript.objects).
[[nodiscard]] SceneScript make_random_tabletop(std::uint64_t seed, const RandomTabletopOptions& options = {});

/// Makes a recording of few views, for tracking: 24 views around a table, 30 cm and 15 deg apart, without changes, from
/// a drawn device (realistic_recording.hpp) with exact poses. Odd seeds have three untextured objects, even ones eight
/// of any kind.
[[nodiscard]] SceneScript make_sparse_views(std::uint64_t seed);

/// Names of the preset scenes: "demo", "tabletop", "crowded" (closely packed, much occlusion), "twins" (similar objects
/// side by side), "plain" (untextured objects), "sparse-views".
[[nodiscard]] const std::vector<std::string>& preset_scene_names();
/// Makes a preset scene. The error for an unknown name lists the known names.
[[nodiscard]] Result<SceneScript> make_preset_scene(std::string_view name, std::uint64_t seed = 1);

}  // namespace resight
