// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "resight/simulation/scene_script.hpp"

namespace resight {

/// Increases with each change of the generator or its defaults. Results of different versions are not comparable.
/// Version 2 is still made on request: its objects are the same for every seed, camera poses and registration are
/// exact, noise is independent per pixel, and there are neither shadows nor gloss.
inline constexpr int kDynamicTabletopVersion = 3;
/// Seeds for tuning and for reporting. Any other seed is equally valid for verification.
inline constexpr std::uint64_t kDynamicTabletopValidationSeed = 1;
inline constexpr std::uint64_t kDynamicTabletopTestSeed = 2;

/// Difficulty of the benchmark. The defaults define the benchmark; docs/benchmark.md explains their choice.
struct DynamicTabletopOptions {
  int version = kDynamicTabletopVersion;  ///< 2 or 3.
  int num_known = 12;                     ///< Known things at the start of a sequence, as far as there is room.
  int num_waiting = 4;                    ///< Further known things, which may come in later.
  int num_unknown = 5;                    ///< Things that are in no library.
  int num_changes = 12;                   ///< Of a sequence, at most (what finds no room does not happen).
  double unknown_share = 0.15;            ///< Of the changes: those of unknown things.
  double lying_share = 0.25;              ///< Of the things: laid on a side.
  double crowding = 0.6;                  ///< Share of the things that are put close to another one.
  double gap_m = 0.004;                   ///< Between neighbours, at least.
  double min_distance_m = 0.75;           ///< Of the camera from what it looks at.
  double max_distance_m = 1.25;
  double sweep = 0.5;        ///< Factor on the arc of the camera and on how far it looks left and right.
  double depth_noise = 1.0;  ///< Factor on Nguyen's lateral and axial sigma. Version 2 only.
  double color_noise = 3.0;  ///< Sigma of each pixel's channels, of 255. Version 2 only.
  /// The frozen settings of a version. Throws std::invalid_argument for a version that does not exist.
  [[nodiscard]] static DynamicTabletopOptions of_version(int version);
  void check() const;  ///< Throws std::invalid_argument: field, value, rule.
};

/// Makes the standard benchmark: 9 sequences with 203 views in all, like the dynamic TUW data set of the paper. Scenes
/// are desks, a meeting table, a table with a low cabinet beside it, and a shelf. Known objects stand close together:
/// some kinds occur twice in a scene, and twins differ only in their texture. Unknown objects include look-alikes of
/// known ones. Objects are moved, removed, added, put back, and put in the former place of another object, often
/// outside the image. The camera sweeps to and fro, so that places are observed again.
///
/// All sequences share one library (dynamic_tabletop_library()). Equal seeds and options give equal scripts.
[[nodiscard]] std::vector<SceneScript> make_dynamic_tabletop(std::uint64_t seed,
                                                             const DynamicTabletopOptions& options = {});

/// Names of the known objects. Version 3: those of seeded_object_names(seed). Version 2: all procedural objects except
/// three, which are unknown look-alikes in the scenes.
[[nodiscard]] std::vector<std::string> dynamic_tabletop_library(std::uint64_t seed,
                                                                int version = kDynamicTabletopVersion);

}  // namespace resight
