// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cmath>
#include <limits>
#include <string>

#include "resight/report/view_record.hpp"

// A small synthetic scene for the tests of the report: two balls and a slab in front of a wall.
namespace resight::test {

inline PointCloud make_ball(double radius_m) {
  PointCloud cloud;
  const int num_points = 4000;
  for (int i = 0; i < num_points; ++i) {  // Fibonacci sphere.
    const double z = 1 - 2 * (i + 0.5) / num_points;
    const double angle = i * 2.399963229728653;
    const double ring = std::sqrt(1 - z * z);
    cloud.points.emplace_back(Eigen::Vector3d(ring * std::cos(angle), ring * std::sin(angle), z).cast<float>() *
                              static_cast<float>(radius_m));
  }
  return cloud;
}

inline PointCloud make_slab(double width_m, double height_m) {
  PointCloud cloud;
  for (double x = -width_m / 2; x <= width_m / 2; x += 0.003) {
    for (double y = -height_m / 2; y <= height_m / 2; y += 0.003) {
      cloud.points.emplace_back(static_cast<float>(x), static_cast<float>(y), 0.0F);
    }
  }
  return cloud;
}

inline ModelLibrary make_library() {
  ModelLibrary library;
  library.surface_voxel_m = 0.003F;
  const std::string names[] = {"ball", "slab", "big_ball"};
  for (int i = 0; i < 3; ++i) {
    ObjectModel model;
    model.name = names[i];
    model.bop_id = 11 + i;
    model.surface = i == 1 ? make_slab(0.2, 0.12) : make_ball(i == 0 ? 0.05 : 0.08);
    library.objects.push_back(std::move(model));
  }
  return library;
}

inline RgbdFrame make_frame() {
  RgbdFrame frame;
  frame.name = "view";
  frame.camera = {320, 240, 260.0, 260.0, 159.5, 119.5};
  frame.color = Image<Rgb8>(320, 240, Rgb8{120, 120, 120});
  frame.depth_m = Image<float>(320, 240, 1.5F);
  frame.depth_m(3, 3) = std::numeric_limits<float>::quiet_NaN();
  frame.world_from_camera =
      Rigid3::from_translation({0.4, -0.2, 0.1}) * Rigid3::from_axis_angle(Eigen::Vector3d(1, 2, 0.5), 0.7);
  return frame;
}

/// A detection whose pose is given in the camera frame.
inline Detection make_detection(const RgbdFrame& frame, int object, const Rigid3& camera_from_object, int track = 0) {
  Detection detection;
  detection.object = object;
  detection.track = track;
  detection.world_from_object = frame.world_from_camera * camera_from_object;
  detection.score = 0.875;
  detection.visible_share = 0.5;
  detection.views.push_back({0, true, 0.5, 0.75});
  detection.views.push_back({1, false, 0.0, std::numeric_limits<double>::quiet_NaN()});
  return detection;
}

inline Rigid3 at(double x, double y, double z) { return Rigid3::from_translation({x, y, z}); }

inline SceneUpdate make_update(const RgbdFrame& frame, int view) {
  SceneUpdate update;
  update.view = view;
  update.view_name = frame.name + std::to_string(view);
  update.world_from_camera = frame.world_from_camera;
  update.times.add("features", 0.25, 0.5);
  update.times.add("verification", 0.5 * view, 0.5 * view);
  update.counts = {500, 20, 30, 10, 2};
  return update;
}

/// View 0: ball and slab are recognised. View 1: the ball has moved, the slab is removed, and a new surface appears.
inline std::vector<SceneUpdate> make_updates(const RgbdFrame& frame) {
  std::vector<SceneUpdate> updates = {make_update(frame, 0), make_update(frame, 1)};
  const Rigid3 old_ball = at(-0.2, 0, 1);
  const Rigid3 new_ball = at(-0.2, 0.3, 1);
  const Rigid3 slab = at(0.2, 0.05, 1.1);
  updates[0].detections = {make_detection(frame, 0, old_ball, 1), make_detection(frame, 1, slab, 2)};
  updates[1].detections = {make_detection(frame, 0, new_ball, 1)};
  const auto world = [&frame](const Rigid3& camera_from_object) {
    return frame.world_from_camera * camera_from_object;
  };
  updates[0].events = {{ObjectEventKind::kFound, 0, 1, 0, std::nullopt, world(old_ball), 0.9},
                       {ObjectEventKind::kFound, 1, 2, 0, std::nullopt, world(slab), 0.8}};
  updates[1].events = {{ObjectEventKind::kMoved, 0, 1, 1, world(old_ball), world(new_ball), 0.9},
                       {ObjectEventKind::kRemoved, 1, 2, 1, world(slab), std::nullopt, 0.7}};
  updates[1].changes.removed_in_world = transform(world(slab), make_slab(0.2, 0.12));
  updates[1].changes.novel_in_world = transform(world(new_ball), make_ball(0.05));
  updates[1].changes.novel_mask = Image<std::uint8_t>(frame.camera.width, frame.camera.height, 0);
  for (int u = 90; u < 120; ++u) updates[1].changes.novel_mask(u, 200) = 1;
  updates[1].changes.removed_mask = updates[1].changes.novel_mask;
  updates[1].changes.changed_share = 0.125;
  return updates;
}

inline ReportRun make_run(const std::string& preset = "default") {
  const RgbdFrame frame = make_frame();
  const ModelLibrary library = make_library();
  ReportRun run;
  run.preset = preset;
  run.sequence = "table <1>";
  run.version = "1.2.3";
  run.settings = {{"num_previous_views", "5"}, {"changes.tolerance_m", "0.02"}};
  run.peak_memory_bytes = 123000000;
  run.num_threads = 2;
  for (SceneUpdate& update : make_updates(frame)) {
    run.views.push_back(make_view_record(frame, library, std::move(update)));
  }
  return run;
}

}  // namespace resight::test
