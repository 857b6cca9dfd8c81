// SPDX-License-Identifier: Apache-2.0
#include "resight/simulation/scene_script.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <iterator>
#include <map>
#include <set>

#include "resight/core/check.hpp"
#include "resight/core/names.hpp"
#include "resight/io/images.hpp"
#include "resight/simulation/room.hpp"
#include "resight/simulation/seeded_objects.hpp"

namespace resight {
namespace {

bool contains(const std::vector<std::string>& names, const std::string& name) {
  return std::ranges::find(names, name) != names.end();
}

std::string join(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : ", ") + name;
  return text;
}

// Follows the script in order of time and tracks the objects that are present.
class ScriptChecker {
 public:
  explicit ScriptChecker(const SceneScript& script) : script_(script), models_(procedural_object_names()) {
    std::ranges::copy(distractor_names(), std::back_inserter(models_));
    if (!script.object_seed) return;
    const SeededObjectNames seeded = seeded_object_names(*script.object_seed);
    std::ranges::copy(seeded.known, std::back_inserter(models_));
    std::ranges::copy(seeded.unknown, std::back_inserter(models_));
  }

  Result<void> check() {
    for (auto step : {&ScriptChecker::check_cameras, &ScriptChecker::check_furniture, &ScriptChecker::check_objects,
                      &ScriptChecker::check_changes}) {
      if (const auto error = (this->*step)()) return *error;
    }
    return {};
  }

 private:
  using Problem = std::optional<Error>;

  Problem check_cameras() {
    const auto is_plain = [](char c) {
      return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_' || c == '-';
    };
    if (script_.name.empty() || !std::ranges::all_of(script_.name, is_plain))
      return Error{"name: '" + script_.name + "' (must be letters, digits, _ or -: it names a folder)"};
    if (const auto named = check_object_name(script_.name); !named) return Error{"name: " + named.error().message};
    if (auto p = check_intrinsics()) return p;
    if (script_.world_from_camera.empty()) return Error{"camera: there is no view (give orbit or pose)"};
    for (const Rigid3& pose : script_.world_from_camera)
      if (!pose.is_rigid()) return Error{"camera: a pose is not a rigid motion"};
    if (!script_.reported_world_from_camera.empty() &&
        script_.reported_world_from_camera.size() != script_.world_from_camera.size())
      return Error{"camera: there must be as many reported as true poses"};
    for (const Rigid3& pose : script_.reported_world_from_camera)
      if (!pose.is_rigid()) return Error{"camera: a reported pose is not a rigid motion"};
    if (script_.room_size_m) return check_size(*script_.room_size_m, kMinRoomSize_m, kMaxRoomSize_m, "room");
    return {};
  }

  Problem check_intrinsics() {
    const Camera& camera = script_.camera;
    if (!camera.is_valid()) return Error{"camera: invalid intrinsics (size and focal lengths must be positive)"};
    if (std::max(camera.width, camera.height) > kMaxImageSide_px ||
        std::int64_t{camera.width} * camera.height > kMaxViewPixels)
      return Error{"camera: " + std::to_string(camera.width) + " x " + std::to_string(camera.height) +
                   " pixels are too many (at most " + std::to_string(kMaxImageSide_px) + " a side, and " +
                   std::to_string(kMaxViewPixels) + ")"};
    if (camera.fx < 0.01 * camera.width || camera.fy < 0.01 * camera.height)
      return Error{"camera: a focal length is less than a hundredth of the size of the image"};
    return {};
  }

  // Thinner or larger boxes are slips of units, and rounding would spoil them.
  static Problem check_size(const Eigen::Vector3d& size_m, double min_m, double max_m, const std::string& where) {
    if (size_m.minCoeff() >= min_m && size_m.maxCoeff() <= max_m) return {};
    return Error{fmt::format("{}.size_m: must be > 0, in {}..{}", where, min_m, max_m)};
  }

  Problem check_furniture() {
    for (std::size_t i = 0; i < script_.furniture.size(); ++i) {
      const FurnitureScript& f = script_.furniture[i];
      const std::string where = "furniture[" + std::to_string(i) + "]";
      if (!contains(furniture_kinds(), f.kind))
        return Error{where + ".kind: unknown kind '" + f.kind + "' (known: " + join(furniture_kinds()) + ")"};
      if (auto p = check_size(f.size_m, 0.001, kMaxFurnitureSize_m, where)) return p;
      if (auto p = add_key(f.key, where)) return p;
      if (auto p = check_placement(f.placement, f.key, where)) return p;
      present_.insert(f.key);
      furniture_.insert(f.key);
    }
    return {};
  }

  Problem check_objects() {
    for (std::size_t i = 0; i < script_.objects.size(); ++i) {
      const ObjectScript& o = script_.objects[i];
      const std::string where = "object[" + std::to_string(i) + "]";
      if (o.mesh.empty() && !contains(models_, o.model))
        return Error{where + ".model: unknown object '" + o.model + "' (known: " + join(models_) + "; or give mesh)"};
      if (const auto named = check_object_name(o.model); !named)
        return Error{where + ".model: " + named.error().message};
      if (auto p = add_key(o.key, where)) return p;
      objects_.insert(o.key);
      if (!o.start) continue;
      if (auto p = check_placement(*o.start, o.key, where)) return p;
      put(o.key, *o.start);
    }
    return {};
  }

  Problem check_changes() {
    int last_view = 1;
    for (std::size_t i = 0; i < script_.changes.size(); ++i) {
      const ChangeScript& c = script_.changes[i];
      const std::string where = "change[" + std::to_string(i) + "]";
      const int num_views = static_cast<int>(script_.world_from_camera.size());
      if (c.view < 1 || c.view >= num_views)
        return Error{where + ".view: " + std::to_string(c.view) + " (must be in 1.." + std::to_string(num_views - 1) +
                     ")"};
      if (c.view < last_view) return Error{where + ".view: changes must be in the order of their views"};
      last_view = c.view;
      if (!objects_.contains(c.object)) return Error{where + ".object: there is no object '" + c.object + "'"};
      const bool is_there = present_.contains(c.object);
      if (c.kind == ChangeKind::kAdded && is_there)
        return Error{where + ": '" + c.object + "' cannot be added, it is there"};
      if (c.kind != ChangeKind::kAdded && !is_there)
        return Error{where + ": '" + c.object + "' cannot be " + std::string(to_string(c.kind)) + ", it is not there"};
      for (const auto& [key, support] : support_of_)
        if (support == c.object)
          return Error{where + ".object: '" + c.object + "' carries '" + key +
                       "', which would float (take that away first)"};
      present_.erase(c.object);
      support_of_.erase(c.object);
      if (c.kind == ChangeKind::kRemoved) continue;
      if (auto p = check_placement(c.placement, c.object, where)) return p;
      put(c.object, c.placement);
    }
    return {};
  }

  void put(const std::string& key, const Placement& placement) {
    present_.insert(key);
    if (!placement.world_from_object) support_of_[key] = placement.support;
  }

  Problem add_key(const std::string& key, const std::string& where) {
    if (key.empty()) return Error{where + ".key: is missing"};
    if (const auto named = check_object_name(key); !named) return Error{where + ".key: " + named.error().message};
    if (!keys_.insert(key).second) return Error{where + ".key: '" + key + "' is used twice"};
    return {};
  }

  Problem check_placement(const Placement& p, const std::string& own_key, const std::string& where) {
    if (p.world_from_object) {
      if (!p.world_from_object->is_rigid()) return Error{where + ".pose: is not a rigid motion"};
      return {};
    }
    if (p.support == own_key) return Error{where + ".on: '" + own_key + "' cannot stand on itself"};
    if (!p.support.empty() && !present_.contains(p.support))
      return Error{where + ".on: '" + p.support + "' is not there (supports come first)"};
    if (p.level < -1 || (p.level >= 0 && !furniture_.contains(p.support)))
      return Error{where + ".level: only furniture has levels, counted from 0"};
    for (const double x : {p.x_m, p.y_m, p.yaw_rad, p.pitch_rad, p.roll_rad})
      if (!std::isfinite(x)) return Error{where + ": a number of the placement is not finite"};
    return {};
  }

  const SceneScript& script_;
  std::vector<std::string> models_;  // without those of mesh files
  std::set<std::string> keys_, present_, furniture_, objects_;
  std::map<std::string, std::string> support_of_;  // of the objects that are present
};

}  // namespace

std::string_view to_string(ChangeKind kind) {
  switch (kind) {
    case ChangeKind::kAdded:
      return "added";
    case ChangeKind::kMoved:
      return "moved";
    case ChangeKind::kRemoved:
      return "removed";
  }
  return "";
}

std::vector<Rigid3> make_orbit(const OrbitScript& orbit) {
  require(orbit.num_views > 0, "OrbitScript.num_views must be > 0");
  check_positive("OrbitScript.radius_m", orbit.radius_m);
  check_positive("OrbitScript.end_radius_m", orbit.end_radius_m.value_or(orbit.radius_m));
  std::vector<Rigid3> poses;
  for (int i = 0; i < orbit.num_views; ++i) {
    const double t = orbit.num_views == 1 ? 0.0 : static_cast<double>(i) / (orbit.num_views - 1);
    const double angle = std::lerp(orbit.start_rad, orbit.end_rad, t);
    const double radius = std::lerp(orbit.radius_m, orbit.end_radius_m.value_or(orbit.radius_m), t);
    const double height = std::lerp(orbit.height_m, orbit.end_height_m.value_or(orbit.height_m), t);
    const Eigen::Vector3d offset(radius * std::cos(angle), radius * std::sin(angle), height);
    poses.push_back(look_at(orbit.center_m + offset, orbit.center_m));
  }
  return poses;
}

Result<ProceduralObject> make_script_object(std::optional<std::uint64_t> object_seed, std::string_view model) {
  if (object_seed)
    if (auto object = make_seeded_object(*object_seed, model)) return object;
  if (auto object = make_procedural_object(model)) return object;
  return make_distractor(model);
}

const Rigid3& reported_pose(const SceneScript& script, int view) {
  const auto i = static_cast<std::size_t>(view);
  return script.reported_world_from_camera.empty() ? script.world_from_camera[i] : script.reported_world_from_camera[i];
}

Result<void> check_script(const SceneScript& script) { return ScriptChecker(script).check(); }

}  // namespace resight
