// SPDX-License-Identifier: Apache-2.0
#include "resight/simulation/recording.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <numbers>

#include "resight/core/check.hpp"
#include "resight/core/files.hpp"
#include "resight/core/random.hpp"
#include "resight/geometry/angle.hpp"
#include "resight/io/ply.hpp"
#include "resight/rendering/view_renderer.hpp"
#include "resight/simulation/mesh_parts.hpp"
#include "resight/simulation/room.hpp"
#include "resight/simulation/texture_designs.hpp"

namespace resight {
namespace {

using Eigen::Vector3d;

constexpr double kTableHeight_m = 0.74;
constexpr double kMinCameraDistance_m = 0.6;
constexpr double kDiscMargin_m = 0.035;  // margin of the turntable around the object
constexpr double kMinDiscRadius_m = 0.10;

// The placed object: it stands on z = 0 with its bounding box `off_axis_m` from the z axis.
struct PutDown {
  Rigid3 stand_from_object;
  double height_m = 0;
  double radius_m = 0;  // about the z axis
};

PutDown put_down(const TriangleMesh& mesh, const RecordingOptions& options, Rng& rng) {
  const Rigid3 turn = Rigid3::from_axis_angle(Vector3d::UnitZ(), rng.uniform(-std::numbers::pi, std::numbers::pi)) *
                      Rigid3::from_axis_angle(Vector3d::UnitX(), options.upside_down ? std::numbers::pi : 0);
  Vector3d low = Vector3d::Constant(1e9);
  Vector3d high = -low;
  for (const Eigen::Vector3f& v : mesh.vertices) {
    const Vector3d p = turn * v.cast<double>().eval();
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  const double toward = rng.uniform(-std::numbers::pi, std::numbers::pi);
  const Vector3d middle = 0.5 * (low + high);
  const Vector3d shift(options.off_axis_m * std::cos(toward) - middle.x(),
                       options.off_axis_m * std::sin(toward) - middle.y(), -low.z());
  PutDown result{Rigid3::from_translation(shift) * turn, high.z() - low.z(), 0};
  for (const Eigen::Vector3f& v : mesh.vertices)
    result.radius_m = std::max(result.radius_m, (result.stand_from_object * v.cast<double>().eval()).head<2>().norm());
  return result;
}

// A grey, slightly worn disc on z = 0, with almost no texture.
TriangleMesh make_turntable_disc(double radius_m, double height_m, std::uint64_t seed) {
  TextureAtlas atlas(1024, std::min(2.0, 450 / (radius_m * 1000)));
  const PixelRect top = atlas.allocate(2000 * radius_m, 2000 * radius_m);
  const Rgb8 grey{168, 170, 172};
  atlas.canvas(top).fill(grey);
  print_grain(atlas.canvas(top), Rng(seed), grey, 60, 1, 4);
  TriangleMesh disc = make_disc_part(radius_m, height_m, true, top);
  const std::array<Eigen::Vector2d, 2> wall{Eigen::Vector2d(radius_m, height_m), Eigen::Vector2d(radius_m, 0)};
  disc.append(make_lathe_part(wall, atlas.solid({120, 122, 124})));
  atlas.finish(disc);
  return disc;
}

void add(RaycastScene& scene, TriangleMesh mesh, const Rigid3& world_from_mesh) {
  scene.add_instance(scene.add_mesh(std::move(mesh)), world_from_mesh);
}

Rigid3 on_table(double x_m, double y_m, double yaw_deg) {
  return Rigid3::from_translation({x_m, y_m, kTableHeight_m}) *
         Rigid3::from_axis_angle(Vector3d::UnitZ(), radians(yaw_deg));
}

// Adds all static things. Upright ones stand behind the turntable, so that nothing hides the object.
void furnish(RaycastScene& scene, const RecordingOptions& options, double disc_radius_m) {
  const std::uint64_t seed = Rng::stream(options.seed, 100).next();
  add(scene, make_room({5.0, 5.0, 2.6}, seed), Rigid3::identity());
  add(scene, make_furniture("table", {1.4, 0.9, kTableHeight_m}, seed + 1)->mesh, Rigid3::identity());
  const double side = disc_radius_m + 0.17;
  add(scene, make_furniture("papers", {0.21, 0.297, 0.001}, seed + 2)->mesh, on_table(-side, 0.0, 20));
  add(scene, make_furniture("papers", {0.21, 0.297, 0.001}, seed + 3)->mesh, on_table(side, -0.05, -35));
  if (options.kind == RecordingKind::kWalk) return;
  add(scene, make_furniture("shelf", {1.0, 0.3, 1.7}, seed + 4)->mesh, Rigid3::from_translation({-0.6, 2.1, 0}));
  add(scene, make_distractor("globe")->mesh, on_table(-0.30, disc_radius_m + 0.16, 0));
  add(scene, make_distractor("speaker")->mesh, on_table(0.28, disc_radius_m + 0.18, 25));
}

struct Stage {
  RaycastScene scene;
  int disc = -1;  // instance; -1 if there is none
  int object = -1;
  PutDown put;
  double ground_m = kTableHeight_m;  // height of the ground below the object
  double distance_m = 0;
};

Stage build_stage(const TriangleMesh& mesh, const RecordingOptions& options) {
  Rng rng = Rng::stream(options.seed, options.upside_down ? 2 : 1);
  Stage stage;
  stage.put = put_down(mesh, options, rng);
  const double half_image = make_kinect_camera().fy * static_cast<double>(diameter(mesh.vertices)) / 240;
  stage.distance_m = options.distance_m > 0 ? options.distance_m : std::max(kMinCameraDistance_m, half_image);
  const double disc_radius_m = std::max(kMinDiscRadius_m, stage.put.radius_m + kDiscMargin_m);
  furnish(stage.scene, options, disc_radius_m);
  if (options.kind == RecordingKind::kTurntable) {
    stage.ground_m += options.disc_height_m;
    stage.disc = stage.scene.num_instances();
    add(stage.scene, make_turntable_disc(disc_radius_m, options.disc_height_m, options.seed), Rigid3::identity());
  }
  stage.object = stage.scene.num_instances();
  add(stage.scene, mesh, Rigid3::identity());
  stage.scene.set_material(stage.object, options.material);
  return stage;
}

// Camera pose after a walk by `angle_rad` (0 on a turntable). The walk is not a perfect circle.
Rigid3 place_camera(const Stage& stage, const RecordingOptions& options, double angle_rad) {
  const bool walks = options.kind == RecordingKind::kWalk;
  const double wave = walks ? std::sin(3 * angle_rad) : 0;
  const double elevation_rad = radians(options.elevation_deg + 3 * wave);
  const double distance_m = stage.distance_m * (1 + 0.04 * (walks ? std::cos(2 * angle_rad) : 0));
  const double azimuth_rad = -std::numbers::pi / 2 - angle_rad;  // starts in front (-y)
  const Vector3d target(0, 0, stage.ground_m + 0.5 * stage.put.height_m);
  return look_at(
      target + distance_m * Vector3d(std::cos(elevation_rad) * std::cos(azimuth_rad),
                                     std::cos(elevation_rad) * std::sin(azimuth_rad), std::sin(elevation_rad)),
      target);
}

RecordedView record_view(Stage& stage, const RecordingOptions& options, int index) {
  const double angle_rad = radians(index * options.step_deg);
  const bool turns = options.kind == RecordingKind::kTurntable;
  const Rigid3 turn = Rigid3::from_axis_angle(Vector3d::UnitZ(), turns ? angle_rad : 0);
  const Rigid3 world_from_object =
      Rigid3::from_translation({0, 0, stage.ground_m}) * turn * stage.put.stand_from_object;
  stage.scene.set_pose(stage.object, world_from_object);
  if (stage.disc >= 0) stage.scene.set_pose(stage.disc, Rigid3::from_translation({0, 0, kTableHeight_m}) * turn);
  stage.scene.commit();

  RecordedView view;
  char name[16];
  std::snprintf(name, sizeof name, "%05d", index);
  view.frame.name = name;
  view.frame.camera = make_kinect_camera();
  const Rigid3 world_from_camera = place_camera(stage, options, turns ? 0 : angle_rad);
  view.camera_from_object = world_from_camera.inverse() * world_from_object;
  RenderOptions render;
  render.num_threads = options.num_threads;
  render.lighting = options.lighting;
  render.linear_light = options.sensor.color_camera.has_value();
  const RenderedView rendered = render_scene(stage.scene, view.frame.camera, world_from_camera, render);
  const std::uint64_t seed = Rng::stream(options.seed, 1000 + 2 * index + (options.upside_down ? 1 : 0)).next();
  view.frame.depth_m = sense_depth(stage.scene, view.frame.camera, world_from_camera, rendered, options.sensor, seed,
                                   options.num_threads);
  view.frame.color = sense_color(rendered, options.sensor, seed, options.num_threads);
  view.mask = Image<std::uint8_t>(rendered.labels.width(), rendered.labels.height());
  std::ranges::transform(rendered.labels.data(), view.mask.data().begin(),
                         [&](int label) -> std::uint8_t { return label == stage.object ? 255 : 0; });
  return view;
}

// The visible share needs no second rendering, because nothing hides the object.
Result<void> write_side(const ProceduralObject& object, const std::filesystem::path& directory, DatasetFormat format,
                        const RecordingOptions& options) {
  auto writer = create_sequence(directory, format);
  if (!writer) return writer.error();
  for (const RecordedView& view : simulate_recording(object.mesh, options)) {
    const GroundTruthObject truth{object.name, 1, 0, view.camera_from_object, 1.0};
    if (auto done = (*writer)->write_view(view.frame, {truth}); !done) return done;
  }
  return (*writer)->finish();
}

}  // namespace

void RecordingOptions::check() const {
  check_in_range("RecordingOptions.step_deg", step_deg, 1, 120);
  check_in_range("RecordingOptions.elevation_deg", elevation_deg, 5, 80);
  check_not_negative("RecordingOptions.distance_m", distance_m);
  check_in_range("RecordingOptions.disc_height_m", disc_height_m, 0.001, 0.2);
  check_in_range("RecordingOptions.off_axis_m", off_axis_m, 0, 0.1);
  check_in_range("RecordingOptions.num_threads", num_threads, 1, 4096);
  sensor.check();
  lighting.check();
  material.check();
}

std::vector<RecordedView> simulate_recording(const TriangleMesh& mesh, const RecordingOptions& options) {
  options.check();
  require(!mesh.empty(), "simulate_recording: the mesh has no faces");
  Stage stage = build_stage(mesh, options);
  const int count = static_cast<int>(std::lround(360 / options.step_deg));
  std::vector<RecordedView> views;
  for (int i = 0; i < count; ++i) views.push_back(record_view(stage, options, i));
  return views;
}

Result<void> write_recordings(const ProceduralObject& object, const std::filesystem::path& directory,
                              DatasetFormat format, RecordingOptions options,
                              const std::function<void(const std::string&)>& progress) {
  auto pending = PendingDirectory::create(directory);
  if (!pending) return pending.error();
  options.material = object.material;
  for (const bool upside_down : {false, true}) {
    options.upside_down = upside_down;
    const std::string side = upside_down ? "side_2" : "side_1";
    if (auto done = write_side(object, pending->path() / side, format, options); !done) return done;
    if (progress) progress(side);
  }
  if (auto done = write_ply(pending->path() / "truth" / (object.name + ".ply"), object.mesh); !done) return done;
  return pending->commit();
}

}  // namespace resight
