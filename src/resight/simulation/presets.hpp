// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <string_view>
#include <vector>

#include "resight/core/result.hpp"
#include "resight/simulation/scene_script.hpp"

namespace resight {

/// The scene of `resight demo`: a desk in a room with ten known objects (one plain, one symmetric) and three unknown
/// ones, monitor and keyboard; 12 views over 120 deg at 0.9 to 1.3 m; five changes in between: two objects are moved,
/// one is removed, one is added and later removed. `seed` shifts and turns the objects a little; it says nothing about
/// the sensor.
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

/// A table in a room with objects at random places that do not overlap, and changes. The same script for the same seed
/// and options. Fewer objects than asked for stand there if the table is full (see SceneScript.objects).
[[nodiscard]] SceneScript make_random_tabletop(std::uint64_t seed, const RandomTabletopOptions& options = {});

/// "demo", "tabletop", "crowded" (closely packed, much occlusion), "twins" (alike objects side by side), "plain"
/// (objects without print). An error for an unknown name, which lists the known ones.
[[nodiscard]] const std::vector<std::string>& preset_scene_names();
[[nodiscard]] Result<SceneScript> make_preset_scene(std::string_view name, std::uint64_t seed = 1);

}  // namespace resight
