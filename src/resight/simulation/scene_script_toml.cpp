// SPDX-License-Identifier: Apache-2.0
#include <numbers>

#include "resight/core/input_file.hpp"
#include "resight/io/toml_keys.hpp"
#include "resight/simulation/camera_drift.hpp"
#include "resight/simulation/internal/toml_fields.hpp"
#include "resight/simulation/scene_script.hpp"

namespace resight {
namespace {

void read_degrees(TomlFields& fields, const std::string& key, double& target_rad) {
  double deg = target_rad * 180 / std::numbers::pi;
  if (!fields.has(key)) {
    fields.read(key, deg);
    return;  // keeps the default free of rounding
  }
  fields.read(key, deg);
  target_rad = deg * std::numbers::pi / 180;
}

void read_vector(TomlFields& fields, const std::string& key, Eigen::Vector3d& target) {
  if (const auto v = fields.read_numbers<3>(key)) target = Eigen::Vector3d((*v)[0], (*v)[1], (*v)[2]);
}

// Reads a 4x4 matrix in row-major order.
std::optional<Rigid3> read_pose(TomlFields& fields, const std::string& key) {
  const auto m = fields.read_numbers<16>(key);
  if (!m) return std::nullopt;
  const Rigid3 pose = Rigid3::from_matrix(Eigen::Map<const Eigen::Matrix<double, 4, 4, Eigen::RowMajor>>(m->data()));
  if (!pose.is_rigid() || (*m)[12] != 0 || (*m)[13] != 0 || (*m)[14] != 0 || (*m)[15] != 1)
    fields.fail(key, "must be a rigid 4x4 matrix, row by row, with the last row 0 0 0 1");
  return pose;
}

Placement read_placement(TomlFields& fields) {
  Placement p;
  fields.read("on", p.support);
  fields.read("level", p.level);
  fields.read("x_m", p.x_m);
  fields.read("y_m", p.y_m);
  read_degrees(fields, "yaw_deg", p.yaw_rad);
  read_degrees(fields, "pitch_deg", p.pitch_rad);
  read_degrees(fields, "roll_deg", p.roll_rad);
  p.world_from_object = read_pose(fields, "pose");
  if (p.world_from_object)
    for (const char* key : {"on", "level", "x_m", "y_m", "yaw_deg", "pitch_deg", "roll_deg"})
      if (fields.has(key)) fields.fail("pose", std::string("excludes ") + key);
  return p;
}

FurnitureScript read_furniture(TomlFields& fields) {
  FurnitureScript f;
  fields.require_key("kind");
  fields.read("kind", f.kind);
  f.key = f.kind;
  fields.read("key", f.key);
  read_vector(fields, "size_m", f.size_m);
  f.placement = read_placement(fields);
  fields.options("material", f.material);
  return f;
}

ObjectScript read_object(TomlFields& fields, const std::filesystem::path& folder) {
  ObjectScript o;
  std::string mesh;
  fields.read("mesh", mesh);
  fields.read("model", o.model);
  if (mesh.empty()) {
    fields.require_key("model");
  } else {
    o.mesh = folder / mesh;  // an absolute path stays unchanged
    if (o.model.empty()) o.model = o.mesh.stem().string();
  }
  o.key = o.model;
  fields.read("key", o.key);
  fields.read("known", o.known);
  bool present = true;
  fields.read("present", present);
  const Placement start = read_placement(fields);
  if (present) {
    o.start = start;
  } else {
    for (const char* key : {"on", "level", "x_m", "y_m", "yaw_deg", "pitch_deg", "roll_deg", "pose"})
      if (fields.has(key)) fields.fail(key, "has no meaning for an object that is not present at the start");
  }
  return o;
}

ChangeScript read_change(TomlFields& fields) {
  ChangeScript c;
  for (const char* key : {"view", "kind", "object"}) fields.require_key(key);
  fields.read("view", c.view);
  fields.read("object", c.object);
  std::string kind;
  fields.read("kind", kind);
  if (kind == "add") {
    c.kind = ChangeKind::kAdded;
  } else if (kind == "move") {
    c.kind = ChangeKind::kMoved;
  } else if (kind == "remove") {
    c.kind = ChangeKind::kRemoved;
  } else {
    fields.fail("kind", "must be \"add\", \"move\" or \"remove\"");
  }
  if (c.kind != ChangeKind::kRemoved) c.placement = read_placement(fields);
  return c;
}

void read_orbit(TomlFields& fields, std::vector<Rigid3>& poses) {
  OrbitScript orbit;
  read_vector(fields, "center_m", orbit.center_m);
  fields.read("radius_m", orbit.radius_m);
  fields.read("height_m", orbit.height_m);
  fields.read("end_radius_m", orbit.end_radius_m);
  fields.read("end_height_m", orbit.end_height_m);
  read_degrees(fields, "start_deg", orbit.start_rad);
  read_degrees(fields, "end_deg", orbit.end_rad);
  fields.read("views", orbit.num_views);
  if (orbit.num_views < 1 || orbit.num_views > 100000) return fields.fail("views", "must be in 1..100000");
  if (!(orbit.radius_m > 0)) return fields.fail("radius_m", "must be > 0");
  if (!(orbit.end_radius_m.value_or(1) > 0)) return fields.fail("end_radius_m", "must be > 0");
  try {
    poses = make_orbit(orbit);
  } catch (const std::invalid_argument&) {
    fields.fail("radius_m", "must not be so small that a camera looks straight up or down");
  }
}

void read_camera_pose(TomlFields& fields, std::vector<Rigid3>& poses) {
  if (const auto pose = read_pose(fields, "matrix")) return poses.push_back(*pose);
  fields.require_key("eye_m");
  fields.require_key("target_m");
  Eigen::Vector3d eye = Eigen::Vector3d::Zero();
  Eigen::Vector3d target = Eigen::Vector3d::UnitX();
  read_vector(fields, "eye_m", eye);
  read_vector(fields, "target_m", target);
  try {
    poses.push_back(look_at(eye, target));
  } catch (const std::invalid_argument&) {
    fields.fail("target_m", "must not lie straight above or below eye_m");
  }
}

void read_drift(TomlFields& fields, SceneScript& script) {
  CameraDriftOptions drift;
  fields.options(drift);
  try {
    script.reported_world_from_camera = drift_poses(script.world_from_camera, drift);
  } catch (const std::invalid_argument& mistake) {
    fields.fail("drift", mistake.what());
  }
}

void read_camera(TomlFields& fields, SceneScript& script) {
  fields.read("width", script.camera.width);
  fields.read("height", script.camera.height);
  fields.read("fx", script.camera.fx);
  fields.read("fy", script.camera.fy);
  script.camera.cx = 0.5 * script.camera.width - 0.5;  // no overflow for any int
  script.camera.cy = 0.5 * script.camera.height - 0.5;
  fields.read("cx", script.camera.cx);
  fields.read("cy", script.camera.cy);
  if (fields.has("orbit") && fields.has("pose")) fields.fail("pose", "excludes orbit");
  fields.table("orbit", [&](TomlFields& f) { read_orbit(f, script.world_from_camera); });
  fields.tables("pose", [&](TomlFields& f) { read_camera_pose(f, script.world_from_camera); });
  fields.options("lens", script.color_lens);
  fields.table("drift", [&](TomlFields& f) { read_drift(f, script); });
}

void read_sensor(TomlFields& fields, SensorOptions& s) {
  fields.read("noise_free", s.noise_free);
  fields.read("lateral_noise", s.lateral_noise);
  fields.read("axial_noise", s.axial_noise);
  fields.read("disparity_step_px", s.disparity_step_px);
  fields.read("baseline_m", s.baseline_m);
  fields.read("projector_shadow", s.projector_shadow);
  fields.read("max_incidence_deg", s.max_incidence_deg);
  fields.read("edge_dropout", s.edge_dropout);
  fields.read("min_depth_m", s.min_depth_m);
  fields.read("max_depth_m", s.max_depth_m);
  fields.read("color_noise", s.color_noise);
  fields.read("gain_sigma", s.gain_sigma);
  fields.read("white_balance_sigma", s.white_balance_sigma);
  if (fields.has("depth_errors")) fields.options("depth_errors", s.depth_errors.emplace());
  if (fields.has("color_camera")) fields.options("color_camera", s.color_camera.emplace());
}

Lamp read_lamp(TomlFields& fields) {
  Lamp lamp;
  read_vector(fields, "position_m", lamp.position_in_world_m);
  read_vector(fields, "intensity", lamp.intensity);
  fields.read("radius_m", lamp.radius_m);
  return lamp;
}

void read_light(TomlFields& fields, Lighting& light) {
  read_vector(fields, "lamp_m", light.lamp_in_world_m);
  fields.read("ambient", light.ambient);
  fields.read("diffuse", light.diffuse);
  fields.read("shadows", light.shadows);
  read_vector(fields, "ambient_color", light.ambient_color);
  fields.tables("lamp", [&](TomlFields& f) { light.lamps.push_back(read_lamp(f)); });
}

void read_room(TomlFields& fields, SceneScript& script) {
  bool enabled = true;
  fields.read("enabled", enabled);
  read_vector(fields, "size_m", *script.room_size_m);
  if (!enabled) script.room_size_m.reset();
}

void read_scene(TomlFields& root, const std::filesystem::path& folder, SceneScript& script) {
  root.read("name", script.name);
  if (root.has("object_seed")) root.read("object_seed", script.object_seed.emplace());
  root.table("room", [&](TomlFields& f) { read_room(f, script); });
  root.table("light", [&](TomlFields& f) { read_light(f, script.lighting); });
  root.table("sensor", [&](TomlFields& f) { read_sensor(f, script.sensor); });
  root.table("camera", [&](TomlFields& f) { read_camera(f, script); });
  root.tables("furniture", [&](TomlFields& f) { script.furniture.push_back(read_furniture(f)); });
  root.tables("object", [&](TomlFields& f) { script.objects.push_back(read_object(f, folder)); });
  root.tables("change", [&](TomlFields& f) { script.changes.push_back(read_change(f)); });
  root.finish();
}

// Option checks throw for mistakes of callers. In a file, the same mistake becomes an error.
std::optional<Error> check_options(const SceneScript& script) {
  try {
    script.sensor.check();
    script.lighting.check();
    script.color_lens.check();
    for (const FurnitureScript& f : script.furniture) f.material.check();
  } catch (const std::invalid_argument& mistake) {
    return Error{mistake.what()};
  }
  return std::nullopt;
}

}  // namespace

Result<SceneScript> read_scene_script(const std::filesystem::path& path) {
  const auto fail = [&](const std::string& what) { return Error{path.string() + ": " + what}; };
  const auto text = read_file(path);
  if (!text) return text.error();
  if (const auto checked = check_toml_keys(*text); !checked) return fail(checked.error().message);
  toml::table table;
  try {
    table = toml::parse(*text);
  } catch (const toml::parse_error& error) {
    return fail("line " + std::to_string(error.source().begin.line) + ": " + std::string(error.description()));
  }
  SceneScript script;
  script.name = path.stem().string();
  std::optional<Error> error;
  TomlFields root(table, "", error);
  read_scene(root, path.parent_path(), script);
  if (!error) error = check_options(script);
  if (error) return fail(error->message);
  if (const auto checked = check_script(script); !checked) return fail(checked.error().message);
  return script;
}

}  // namespace resight
