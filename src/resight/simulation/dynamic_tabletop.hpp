// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "resight/simulation/scene_script.hpp"

namespace resight {

/// Grows with each change of the generator or of its defaults: results of different versions do not compare.
inline constexpr int kDynamicTabletopVersion = 2;
/// To tune on, and to report on. Any other seed is as good for whoever doubts.
inline constexpr std::uint64_t kDynamicTabletopValidationSeed = 1;
inline constexpr std::uint64_t kDynamicTabletopTestSeed = 2;

/// How hard the benchmark is. The defaults ARE the benchmark: docs/benchmark.md tells how they were found.
struct DynamicTabletopOptions {
  int num_known = 12;         ///< Known things at the start of a sequence, as far as there is room.
  int num_waiting = 4;          ///< Further known things, which may come in later.
  int num_unknown = 5;          ///< Things that are in no library.
  int num_changes = 32;         ///< Of a sequence, at most (what finds no room does not happen).
  double unknown_share = 0.15;  ///< Of the changes: those of unknown things.
  double lying_share = 0.25;    ///< Of the things: laid on a side.
  double crowding = 0.6;        ///< Share of the things that are put close to another one.
  double gap_m = 0.004;         ///< Between neighbours, at least.
  double min_distance_m = 0.9;  ///< Of the camera from what it looks at.
  double max_distance_m = 1.45;
  double depth_noise = 1.0;  ///< Factor on Nguyen's lateral and axial sigma.
  double color_noise = 3.0;  ///< Sigma of each pixel's channels, of 255.
  void check() const;        ///< Throws std::invalid_argument: field, value, rule.
};

/// The standard benchmark: 9 sequences, 203 views in all, as the dynamic TUW data set of the paper. Desks, a meeting
/// table, a table with a low cabinet beside it, and a shelf, with known objects close together, two kinds twice in a
/// scene, twins that differ in their print only, unknown things (among them look-alikes of known ones), and changes:
/// things are moved, taken away, brought, put back, and put where another one stood, often while the camera looks
/// elsewhere. The camera sweeps to and fro, so places are seen again.
///
/// All sequences have one library (dynamic_tabletop_library()). The same scripts for the same seed and options.
[[nodiscard]] std::vector<SceneScript> make_dynamic_tabletop(std::uint64_t seed,
                                                             const DynamicTabletopOptions& options = {});

/// Names of the known objects; all procedural objects but three, which stand in the scenes as unknown look-alikes.
[[nodiscard]] std::vector<std::string> dynamic_tabletop_library();

}  // namespace resight
