// SPDX-License-Identifier: Apache-2.0
#include "resight/simulation/internal/scene_state.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "resight/core/random.hpp"
#include "resight/io/mesh.hpp"
#include "resight/simulation/room.hpp"

namespace resight {
namespace {

using Eigen::Vector3d;
using Role = SimulatedInstance::Role;

constexpr std::uint64_t kFurnitureStream = 0xF0;
constexpr double kMinUprightCosine = 1 - 1e-6;  // 0.08 deg

Rigid3 rotation_of(const Placement& p) {
  return Rigid3::from_axis_angle(Vector3d::UnitZ(), p.yaw_rad) *
         Rigid3::from_axis_angle(Vector3d::UnitY(), p.pitch_rad) *
         Rigid3::from_axis_angle(Vector3d::UnitX(), p.roll_rad);
}

struct HeightRange {
  double low = std::numeric_limits<double>::infinity();
  double high = -std::numeric_limits<double>::infinity();
};

HeightRange height_range(const TriangleMesh& mesh, const Rigid3& world_from_mesh) {
  HeightRange range;
  const Eigen::RowVector3f up = world_from_mesh.rotation.row(2).cast<float>();
  for (const auto& v : used_vertices(mesh)) {
    const double z = up.dot(v) + world_from_mesh.translation.z();
    range.low = std::min(range.low, z);
    range.high = std::max(range.high, z);
  }
  return range;
}

bool has_model(const std::vector<ProceduralObject>& models, const std::string& name) {
  return std::ranges::find(models, name, &ProceduralObject::name) != models.end();
}

class StateBuilder {
 public:
  StateBuilder(SceneScript script, std::uint64_t seed) : seed_(seed) { state_.script = std::move(script); }

  Result<SceneState> build() {
    if (auto checked = check_script(state_.script); !checked) return fail(checked.error());
    if (state_.script.room_size_m)
      add_instance("room", "room", Role::kRoom, make_room(*state_.script.room_size_m, seed_));
    if (!state_.instances.empty()) current_.back() = Rigid3::identity();
    for (const FurnitureScript& f : state_.script.furniture)
      if (auto added = add_furniture(f); !added) return fail(added.error());
    for (const ObjectScript& o : state_.script.objects)
      if (auto added = add_object(o); !added) return fail(added.error());
    sort_models();
    for (std::size_t view = 0; view < state_.script.world_from_camera.size(); ++view) {
      for (const ChangeScript& c : state_.script.changes)
        if (c.view == static_cast<int>(view))
          if (auto applied = apply(c); !applied) return fail(applied.error());
      state_.poses.push_back(current_);
      state_.placements.push_back(placement_);
    }
    return std::move(state_);
  }

 private:
  [[nodiscard]] Error fail(const Error& error) const {
    return {"scene '" + state_.script.name + "': " + error.message};
  }

  void add_instance(const std::string& key, const std::string& model, Role role, TriangleMesh mesh) {
    add_instance(key, model, role, std::make_shared<const TriangleMesh>(std::move(mesh)));
  }
  void add_instance(const std::string& key, const std::string& model, Role role,
                    std::shared_ptr<const TriangleMesh> mesh) {
    index_[key] = static_cast<int>(state_.instances.size());
    state_.instances.push_back({key, model, role, -1});
    state_.meshes.push_back(std::move(mesh));
    state_.materials.emplace_back();
    levels_.emplace_back();
    current_.emplace_back();
    placement_.push_back(-1);
  }

  Result<void> add_furniture(const FurnitureScript& f) {
    auto furniture =
        make_furniture(f.kind, f.size_m, Rng::stream(seed_ + kFurnitureStream, state_.instances.size()).next());
    if (!furniture) return furniture.error();
    add_instance(f.key, f.kind, Role::kFurniture, std::move(furniture->mesh));
    levels_.back() = furniture->level_heights_m;
    state_.materials.back() = f.material;
    return put(f.key, f.placement);
  }

  Result<void> add_object(const ObjectScript& o) {
    if (auto loaded = load_model(o); !loaded) return loaded.error();
    const auto& [object, mesh] = models_.at(o.model);
    const bool known = o.known && object.kind != "distractor";
    add_instance(o.key, o.model, known ? Role::kKnown : Role::kDistractor, mesh);
    state_.materials.back() = object.material;
    std::vector<ProceduralObject>& models = known ? state_.library : state_.unknown_objects;
    if (!has_model(models, o.model)) models.push_back(object);
    if (!o.start) return {};
    return put(o.key, *o.start);
  }

  Result<void> load_model(const ObjectScript& o) {
    if (models_.contains(o.model)) {
      if (mesh_files_[o.model] != o.mesh)
        return Error{"object '" + o.key + "': model '" + o.model + "' stands for two different meshes"};
      return {};
    }
    Result<ProceduralObject> object = Error{};
    if (!o.mesh.empty()) {
      auto file = read_mesh(o.mesh);
      if (!file) return Error{"object '" + o.key + "': " + file.error().message};
      object = ProceduralObject{o.model, std::move(file->mesh), {}, "mesh"};
    } else {
      object = make_script_object(state_.script.object_seed, o.model);
    }
    if (!object) return object.error();
    auto mesh = std::make_shared<const TriangleMesh>(object->mesh);
    models_.emplace(o.model, std::pair{std::move(*object), std::move(mesh)});
    mesh_files_[o.model] = o.mesh;
    return {};
  }

  // The pose that results from the placement of an object with this mesh.
  Result<Rigid3> resolve(const Placement& p, const TriangleMesh& mesh, const std::string& key) const {
    if (p.world_from_object) return *p.world_from_object;
    double top = 0;
    Vector3d center = Vector3d::Zero();
    Rigid3 turn;
    if (!p.support.empty()) {
      const int support = index_.at(p.support);
      const Rigid3& pose = *current_[support];
      const std::vector<double>& levels = levels_[support];
      const bool is_furniture = state_.instances[support].role == Role::kFurniture;
      if (is_furniture && (levels.empty() || p.level >= static_cast<int>(levels.size())))
        return Error{"'" + key + "': '" + p.support + "' has " + std::to_string(levels.size()) + " levels to stand on"};
      if (is_furniture && pose.rotation(2, 2) < kMinUprightCosine)
        return Error{"'" + key + "': '" + p.support + "' is not upright, so nothing can stand on it"};
      top = is_furniture ? pose.translation.z() + (p.level < 0 ? levels.back() : levels[p.level])
                         : height_range(*state_.meshes[support], pose).high;
      center = pose.translation;
      turn = Rigid3::from_axis_angle(Vector3d::UnitZ(), std::atan2(pose.rotation(1, 0), pose.rotation(0, 0)));
    }
    Rigid3 world_from_object = turn * rotation_of(p);
    const Vector3d shift = turn * Vector3d(p.x_m, p.y_m, 0);
    world_from_object.translation = {center.x() + shift.x(), center.y() + shift.y(), 0};
    world_from_object.translation.z() = top - height_range(mesh, world_from_object).low;
    return world_from_object;
  }

  Result<void> put(const std::string& key, const Placement& placement) {
    const int i = index_.at(key);
    auto pose = resolve(placement, *state_.meshes[i], key);
    if (!pose) return pose.error();
    current_[i] = *pose;
    ++placement_[i];
    return {};
  }

  Result<void> apply(const ChangeScript& c) {
    const int i = index_.at(c.object);
    ScriptedEvent event{
        c.view, c.kind, state_.instances[i].model, c.object, state_.instances[i].role == Role::kKnown, current_[i], {}};
    current_[i].reset();
    if (c.kind != ChangeKind::kRemoved)
      if (auto done = put(c.object, c.placement); !done) return done;
    event.world_from_object_after = current_[i];
    state_.events.push_back(std::move(event));
    return {};
  }

  void sort_models() {
    std::ranges::sort(state_.library, {}, &ProceduralObject::name);
    std::ranges::sort(state_.unknown_objects, {}, &ProceduralObject::name);
    for (SimulatedInstance& instance : state_.instances)
      for (std::size_t i = 0; i < state_.library.size(); ++i)
        if (instance.role == Role::kKnown && instance.model == state_.library[i].name)
          instance.object = static_cast<int>(i);
  }

  std::uint64_t seed_;
  SceneState state_;
  std::map<std::string, int> index_;
  std::map<std::string, std::pair<ProceduralObject, std::shared_ptr<const TriangleMesh>>> models_;
  std::map<std::string, std::filesystem::path> mesh_files_;
  std::vector<std::vector<double>> levels_;
  std::vector<std::optional<Rigid3>> current_;
  std::vector<int> placement_;
};

}  // namespace

Result<SceneState> build_scene_state(SceneScript script, std::uint64_t seed) {
  return StateBuilder(std::move(script), seed).build();
}

}  // namespace resight
