// SPDX-License-Identifier: Apache-2.0
#include "resight/rendering/turntable.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <iterator>
#include <numbers>
#include <string>

#include "resight/core/check.hpp"
#include "resight/core/parallel.hpp"
#include "resight/core/random.hpp"
#include "resight/rendering/sensor_model.hpp"
#include "resight/rendering/view_renderer.hpp"

namespace resight {
namespace {

constexpr double kMinDistance_m = 0.5;
constexpr Rgb8 kBackdrop{128, 128, 128};

struct Bounds {
  Eigen::Vector3d center = Eigen::Vector3d::Zero();
  double diameter_m = 0;
};

Bounds bounds_of(const TriangleMesh& mesh) {
  const std::vector<Eigen::Vector3f> vertices = used_vertices(mesh);
  require(!vertices.empty(), "render_turntable: the triangles of the mesh have no area");
  Eigen::Vector3f low = vertices.front();
  Eigen::Vector3f high = low;
  for (const auto& v : vertices) {
    low = low.cwiseMin(v);
    high = high.cwiseMax(v);
  }
  return {(0.5F * (low + high)).cast<double>(), static_cast<double>(diameter(vertices))};
}

// Camera poses around the object. For the other side, the object is turned upside down, not the camera: in the object
// frame the camera is below, and -z is up in its image.
std::vector<Rigid3> ring_of_poses(const Eigen::Vector3d& center, double distance_m, double elevation_rad,
                                  double step_deg, bool upside_down) {
  const int count = std::max(1, static_cast<int>(std::lround(360.0 / step_deg)));
  const double side = upside_down ? -1.0 : 1.0;
  std::vector<Rigid3> poses;
  for (int i = 0; i < count; ++i) {
    const double angle = -std::numbers::pi / 2 + 2 * std::numbers::pi * i / count;  // starts in front (-y)
    const Eigen::Vector3d direction(std::cos(elevation_rad) * std::cos(angle),
                                    std::cos(elevation_rad) * std::sin(angle), side * std::sin(elevation_rad));
    poses.push_back(look_at(center + distance_m * direction, center, side * Eigen::Vector3d::UnitZ()));
  }
  return poses;
}

TrainingView render_training_view(const RaycastScene& scene, const Rigid3& object_from_camera, const std::string& name,
                                  const TurntableOptions& options, std::uint64_t view_seed) {
  TrainingView view;
  view.frame.name = name;
  view.frame.camera = make_kinect_camera();
  view.frame.world_from_camera = object_from_camera;
  RenderOptions render;
  render.background = kBackdrop;
  // The lamp is fixed above and beside the camera, as over a real turntable. Light and texture therefore rotate
  // relative to each other.
  render.lighting.lamp_in_world_m = object_from_camera * Eigen::Vector3d(0.8, -1.5, -0.3);
  RenderedView rendered = render_scene(scene, view.frame.camera, object_from_camera, render);
  SensorOptions sensor;
  sensor.noise_free = !options.sensor_noise;
  sensor.min_depth_m = 0.4;  // a turntable may be closer than the furniture of a room
  view.frame.depth_m = sense_depth(scene, view.frame.camera, object_from_camera, rendered, sensor, view_seed);
  view.frame.color = sense_color(rendered.color, sensor, view_seed);
  view.mask = Image<std::uint8_t>(rendered.labels.width(), rendered.labels.height());
  std::ranges::transform(rendered.labels.data(), view.mask.data().begin(),
                         [](int label) -> std::uint8_t { return label >= 0 ? 255 : 0; });
  return view;
}

}  // namespace

std::vector<TrainingView> render_turntable(const TriangleMesh& mesh, const TurntableOptions& options) {
  options.check();
  RaycastScene scene;
  scene.add_instance(scene.add_mesh(mesh), Rigid3::identity());
  scene.commit();
  const Bounds bounds = bounds_of(mesh);
  const Camera camera = make_kinect_camera();
  const double half_image = camera.fy * bounds.diameter_m / (0.5 * camera.height);
  const double distance_m = options.distance_m > 0 ? options.distance_m : std::max(kMinDistance_m, half_image);
  const double elevation_rad = options.elevation_deg * std::numbers::pi / 180;
  std::vector<Rigid3> poses = ring_of_poses(bounds.center, distance_m, elevation_rad, options.step_deg, false);
  if (options.both_sides)
    std::ranges::copy(ring_of_poses(bounds.center, distance_m, elevation_rad, options.step_deg, true),
                      std::back_inserter(poses));
  std::vector<TrainingView> views(poses.size());
  parallel_for(poses.size(), options.num_threads, [&](std::size_t i) {
    char name[32];
    std::snprintf(name, sizeof name, "%08d", static_cast<int>(i));
    views[i] = render_training_view(scene, poses[i], name, options, Rng::stream(options.seed, i).next());
  });
  return views;
}

}  // namespace resight
