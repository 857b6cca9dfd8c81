// SPDX-License-Identifier: Apache-2.0
// Detects what changed between views, without models. A synthetic camera looks at a wall; a box in front of it
// disappears.
#include <cstdio>

#include "resight/reconstruction/dynamic_scene.hpp"

namespace {

constexpr float kWallDepth_m = 1.5F;
constexpr float kBoxDepth_m = 1.2F;

/// A frontal view of the wall, with or without a box in the middle.
resight::RgbdFrame make_view(const char* name, bool with_box) {
  resight::RgbdFrame frame;
  frame.name = name;
  frame.camera = resight::make_kinect_camera();
  frame.color = resight::Image<resight::Rgb8>(640, 480, {180, 180, 180});
  frame.depth_m = resight::Image<float>(640, 480, kWallDepth_m);
  for (int v = 200; with_box && v < 280; ++v) {
    for (int u = 280; u < 360; ++u) frame.depth_m(u, v) = kBoxDepth_m;
  }
  return frame;  // frame.world_from_camera is the identity: the camera is static.
}

}  // namespace

int main() {
  resight::DynamicSceneOptions options;
  options.num_previous_views = 5;
  resight::DynamicScene scene(options);
  std::size_t num_removed = 0;
  for (const auto& [name, with_box] : {std::pair("box", true), std::pair("no box", false)}) {
    const auto changes = scene.add_view(resight::prepare_view(make_view(name, with_box)));
    const Eigen::Vector3f where = resight::centroid(changes.removed_in_world.points);
    num_removed = changes.removed_in_world.size();
    std::printf("%-7s removed %zu points around (%.2f %.2f %.2f) m, novel %zu; the scene has %zu points\n", name,
                num_removed, where.x(), where.y(), where.z(), changes.novel_in_world.size(),
                scene.reconstruction().size());
  }
  return num_removed > 0 ? 0 : 1;  // The removed points are those of the box.
}
