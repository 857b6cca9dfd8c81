// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "resight/core/result.hpp"
#include "resight/geometry/triangle_mesh.hpp"
#include "resight/simulation/procedural_objects.hpp"

namespace resight {

/// A piece of furniture. Metres; origin at the bottom centre, +z up, front at -y. Its levels support objects.
struct Furniture {
  TriangleMesh mesh;
  std::vector<double> level_heights_m;  ///< From the lowest to the highest; empty if it supports nothing.
};

/// Kinds: table, shelf (four boards), cabinet, monitor, keyboard, papers.
[[nodiscard]] const std::vector<std::string>& furniture_kinds();

inline constexpr int kMaxFurnitureSize_m = 10;

/// Draws a piece of furniture of the given outer size. `seed` varies colours and textures. The error for an unknown
/// kind lists the known kinds. Throws std::invalid_argument for a size that is not positive, or above
/// kMaxFurnitureSize_m.
[[nodiscard]] Result<Furniture> make_furniture(std::string_view kind, const Eigen::Vector3d& size_m,
                                               std::uint64_t seed);

/// Limits of scenes. The time to draw the grain of walls and floor grows with their area.
inline constexpr double kMinRoomSize_m = 0.5;
inline constexpr double kMaxRoomSize_m = 50;

/// Draws a floor at z = 0, a ceiling and four walls with pictures, centred in x and y.
[[nodiscard]] TriangleMesh make_room(const Eigen::Vector3d& size_m, std::uint64_t seed);

/// Names of objects that belong to no library: vase, lamp, plant, speaker, globe, pyramid, basket, thermos.
[[nodiscard]] const std::vector<std::string>& distractor_names();
/// Draws one of them, with kind "distractor". Fails for an unknown name.
[[nodiscard]] Result<ProceduralObject> make_distractor(std::string_view name);

}  // namespace resight
