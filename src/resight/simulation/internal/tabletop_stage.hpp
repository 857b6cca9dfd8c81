// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

#include "resight/core/random.hpp"
#include "resight/simulation/internal/footprint.hpp"
#include "resight/simulation/scene_script.hpp"

namespace resight {

/// Furniture of a sequence of the benchmark.
enum class TabletopTheme : std::uint8_t { kDesk, kMeeting, kCorner, kShelf };

/// A level of a piece of furniture that supports objects.
struct TabletopSurface {
  std::string support;
  int level = -1;
  Eigen::Vector2d half_area;  ///< In metres, in the frame of the surface.
  std::vector<Footprint> obstacles;
};

/// The furnished room of a sequence without objects.
struct TabletopStage {
  std::vector<TabletopSurface> surfaces;
  Eigen::Vector3d look_at_point_m = Eigen::Vector3d::Zero();  ///< Centre of the camera path, world frame.
  Eigen::Vector2d pan_m = Eigen::Vector2d::Zero();  ///< Largest offset of the viewing target from that centre.
  double half_arc_rad = 0;                          ///< Largest angle of the camera path to either side.
};

/// Adds room, lamp and furniture to the script.
[[nodiscard]] TabletopStage furnish_tabletop(TabletopTheme theme, Rng& rng, SceneScript& script);

}  // namespace resight
