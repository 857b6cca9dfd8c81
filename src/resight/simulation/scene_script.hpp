// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "resight/core/result.hpp"
#include "resight/geometry/camera.hpp"
#include "resight/geometry/rigid3.hpp"
#include "resight/rendering/sensor_model.hpp"
#include "resight/simulation/procedural_objects.hpp"

namespace resight {

/// Placement of an object: on a support (furniture or another object), or at a full pose.
struct Placement {
  std::string support;  ///< Key of the support; empty = the floor. The lowest point of the object touches the support.
  int level = -1;       ///< Board of a piece of furniture, counted from below; -1 = the highest.
  /// Position of the origin relative to that of the support (the middle of furniture and of things that stand upright;
  /// the bottom of one that lies), along the horizontal axes of the support.
  double x_m = 0;
  double y_m = 0;
  double yaw_rad = 0;                       ///< About +z, relative to the support; applied last.
  double pitch_rad = 0;                     ///< About y, applied second: tilts the object.
  double roll_rad = 0;                      ///< About x, applied first: lays the object down.
  std::optional<Rigid3> world_from_object;  ///< If set, all other fields are ignored.
};

/// A piece of furniture of a scene.
struct FurnitureScript {
  std::string key;
  std::string kind;  ///< See furniture_kinds().
  Eigen::Vector3d size_m = Eigen::Vector3d(1.2, 0.8, 0.74);
  Placement placement;
  SurfaceMaterial material = {};
};

/// An object of a scene, known or not.
struct ObjectScript {
  std::string key;  ///< Unique; names the instance in changes.
  /// From procedural_object_names(), distractor_names() or those of SceneScript::object_seed, or any name if `mesh` is
  /// set.
  std::string model;
  std::filesystem::path mesh;      ///< Mesh file (metres, +z up) instead of a procedural object.
  bool known = true;               ///< Whether the object is in the library. Distractors never are.
  std::optional<Placement> start;  ///< Absent if the object is added later.
};

/// Kind of a change of an object.
enum class ChangeKind { kAdded, kMoved, kRemoved };
[[nodiscard]] std::string_view to_string(ChangeKind kind);

/// A change that takes effect before the given view.
struct ChangeScript {
  int view = 0;
  ChangeKind kind = ChangeKind::kMoved;
  std::string object;   ///< Key.
  Placement placement;  ///< The new place; unused for kRemoved.
};

/// A scene, the path of the camera, and the changes.
struct SceneScript {
  std::string name = "scene";
  std::optional<Eigen::Vector3d> room_size_m = Eigen::Vector3d(5.0, 5.0, 2.6);  ///< nullopt = no room
  std::vector<FurnitureScript> furniture;
  std::vector<ObjectScript> objects;
  std::optional<std::uint64_t> object_seed = {};  ///< Of further models that objects may have (seeded_objects.hpp).
  std::vector<ChangeScript> changes;
  Camera camera = make_kinect_camera();
  std::vector<Rigid3> world_from_camera;  ///< The true poses, one per view.
  /// What the tracker of the camera reports, one per view; empty = the true poses.
  std::vector<Rigid3> reported_world_from_camera = {};
  /// Left over in colour images unless sensor.noise_free; `camera` is the ideal camera.
  ResidualDistortion color_lens = {};
  SensorOptions sensor;
  Lighting lighting;
};

/// Cameras on an arc around `center_m`, all looking at it. Angles increase from +x towards +y; -90 deg is in front of
/// the furniture.
struct OrbitScript {
  Eigen::Vector3d center_m = Eigen::Vector3d(0, 0, 0.8);
  double radius_m = 1.0;  ///< Horizontal distance at the first view.
  double height_m = 0.6;  ///< Above the centre, at the first view.
  /// At the last view, with linear interpolation in between. Absent = constant.
  std::optional<double> end_radius_m = {};
  std::optional<double> end_height_m = {};
  double start_rad = -2.6179938779914944;  ///< -150 deg.
  double end_rad = -0.5235987755982988;    ///< -30 deg.
  int num_views = 12;
};
/// Poses (world_from_camera) of an orbit. Throws std::invalid_argument unless num_views > 0.
[[nodiscard]] std::vector<Rigid3> make_orbit(const OrbitScript& orbit);

/// Draws the object that a script calls `model`. The error for an unknown name lists the known ones.
[[nodiscard]] Result<ProceduralObject> make_script_object(std::optional<std::uint64_t> object_seed,
                                                          std::string_view model);

/// The pose that is written for a view.
[[nodiscard]] const Rigid3& reported_pose(const SceneScript& script, int view);

/// Checks that keys are unique, supports and objects exist when they are used, changes are possible (a removed object
/// was present, ...), and there is a view. The error names the entry and the rule.
[[nodiscard]] Result<void> check_script(const SceneScript& script);

/// Reads a scene from TOML (examples/scenes/ documents the keys). Errors name file, key and rule; unknown keys are
/// errors. Mesh paths are relative to the file.
[[nodiscard]] Result<SceneScript> read_scene_script(const std::filesystem::path& path);

}  // namespace resight
