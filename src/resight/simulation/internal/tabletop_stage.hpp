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

enum class TabletopTheme : std::uint8_t { kDesk, kMeeting, kCorner, kShelf };

/// A level of a piece of furniture that things stand on.
struct TabletopSurface {
  std::string support;
  int level = -1;
  Eigen::Vector2d half_area;  ///< Metres, in the surface's frame.
  std::vector<Footprint> obstacles;
};

/// The furnished room of a sequence, before things are put into it.
struct TabletopStage {
  std::vector<TabletopSurface> surfaces;
  Eigen::Vector3d look_at_point_m = Eigen::Vector3d::Zero();  ///< What the camera circles, world frame.
  Eigen::Vector2d pan_m = Eigen::Vector2d::Zero();            ///< How far it looks beside that.
  double half_arc_rad = 0;                                    ///< How far it goes around it, to either side.
};

/// Draws room, lamp and furniture into the script.
[[nodiscard]] TabletopStage furnish_tabletop(TabletopTheme theme, Rng& rng, SceneScript& script);

}  // namespace resight
