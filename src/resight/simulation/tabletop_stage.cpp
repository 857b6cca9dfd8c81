// SPDX-License-Identifier: Apache-2.0
#include "resight/simulation/internal/tabletop_stage.hpp"

#include <numbers>
#include <utility>

#include "resight/geometry/angle.hpp"

namespace resight {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

class Furnisher {
 public:
  Furnisher(Rng& rng, SceneScript& script) : rng_(rng), script_(script) {}

  TabletopStage furnish(TabletopTheme theme) {
    // One draw per statement: compilers differ in the order of arguments. Frozen versions drew the last one first.
    const double room_y_m = rng_.uniform(4.6, 5.4);
    script_.room_size_m = Vector3d(rng_.uniform(4.6, 5.4), room_y_m, 2.6);
    const double lamp_y_m = rng_.uniform(-1.5, 1.0);
    script_.lighting.lamp_in_world_m = Vector3d(rng_.uniform(-1.5, 1.5), lamp_y_m, 2.5);
    script_.lighting.ambient = rng_.uniform(0.45, 0.6);
    switch (theme) {
      case TabletopTheme::kDesk:
        furnish_desk();
        break;
      case TabletopTheme::kMeeting:
        furnish_meeting();
        break;
      case TabletopTheme::kCorner:
        furnish_corner();
        break;
      case TabletopTheme::kShelf:
        furnish_shelf();
        break;
    }
    return std::move(stage_);
  }

 private:
  void add_furniture(const std::string& key, const std::string& kind, const Vector3d& size_m, const std::string& on,
                     const Vector2d& at_m, double yaw_rad = 0) {
    Placement p;
    p.support = on;
    p.x_m = at_m.x();
    p.y_m = at_m.y();
    p.yaw_rad = yaw_rad;
    script_.furniture.push_back({key, kind, size_m, p});
  }

  // Adds an obstacle on the first surface, whose area is no longer free.
  void add_obstacle(const std::string& kind, const Vector3d& size_m, const Vector2d& at_m, double yaw_rad) {
    add_furniture(kind, kind, size_m, stage_.surfaces[0].support, at_m, yaw_rad);
    stage_.surfaces[0].obstacles.push_back({at_m, 0.5 * size_m.head<2>(), yaw_rad});
  }

  void add_papers(int count) {
    for (int i = 0; i < count; ++i) {
      const double y_m = rng_.uniform(-0.25, 0.1);
      const double x_m = rng_.uniform(-0.5, 0.5);
      const double yaw_rad = rng_.uniform(-std::numbers::pi, std::numbers::pi);
      // Papers are so thin that objects may stand on them.
      add_furniture("papers" + std::to_string(i), "papers", {0.21, 0.297, 0.001}, stage_.surfaces[0].support,
                    {x_m, y_m}, yaw_rad);
    }
  }

  void furnish_desk() {
    const Vector3d size(rng_.uniform(1.4, 1.6), 0.85, 0.74);
    add_furniture("desk", "table", size, "", {0, 0});
    add_furniture("shelf", "shelf", {1.0, 0.3, 1.7}, "", {rng_.uniform(-1.2, 1.2), 2.0});
    stage_.surfaces.push_back({"desk", -1, Vector2d(0.5 * size.x() - 0.06, 0.38), {}});
    const double monitor_yaw_rad = rng_.uniform(-0.25, 0.25);
    add_obstacle("monitor", {0.50, 0.18, 0.38}, {rng_.uniform(-0.35, 0.35), 0.28}, monitor_yaw_rad);
    const double keyboard_yaw_rad = rng_.uniform(-0.2, 0.2);
    add_obstacle("keyboard", {0.36, 0.13, 0.02}, {rng_.uniform(-0.2, 0.2), -0.28}, keyboard_yaw_rad);
    add_papers(1);
    stage_.look_at_point_m = {0, -0.02, 0.80};
    stage_.pan_m = {0.25, 0};
    stage_.half_arc_rad = radians(55);
  }

  void furnish_meeting() {
    add_furniture("table", "table", {1.5, 1.0, 0.74}, "", {0, 0});
    add_furniture("cabinet", "cabinet", {0.8, 0.45, 0.9}, "", {rng_.uniform(-1.2, 1.2), 2.0});
    stage_.surfaces.push_back({"table", -1, Vector2d(0.69, 0.44), {}});
    add_papers(3);
    stage_.look_at_point_m = {0, 0, 0.80};
    stage_.pan_m = {0.20, 0.08};
    stage_.half_arc_rad = radians(80);
  }

  void furnish_corner() {
    add_furniture("table", "table", {1.2, 0.8, 0.74}, "", {-0.35, 0});
    add_furniture("cabinet", "cabinet", {0.8, 0.5, 0.55}, "", {0.72, 0.05});
    stage_.surfaces.push_back({"table", -1, Vector2d(0.54, 0.35), {}});
    stage_.surfaces.push_back({"cabinet", -1, Vector2d(0.36, 0.22), {}});
    add_papers(1);
    stage_.look_at_point_m = {0.1, 0, 0.74};
    stage_.pan_m = {0.45, 0};
    stage_.half_arc_rad = radians(45);
  }

  void furnish_shelf() {
    add_furniture("shelf", "shelf", {1.3, 0.36, 1.5}, "", {0, 0});
    for (const int level : {1, 2, 3}) stage_.surfaces.push_back({"shelf", level, Vector2d(0.60, 0.165), {}});
    stage_.look_at_point_m = {0, 0, 0.95};
    stage_.pan_m = {0.25, 0};
    stage_.half_arc_rad = radians(38);
  }

  Rng& rng_;
  SceneScript& script_;
  TabletopStage stage_;
};

}  // namespace

TabletopStage furnish_tabletop(TabletopTheme theme, Rng& rng, SceneScript& script) {
  return Furnisher(rng, script).furnish(theme);
}

}  // namespace resight
