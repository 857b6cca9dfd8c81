// SPDX-License-Identifier: Apache-2.0
#include "resight/simulation/simulation.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>

#include "resight/core/check.hpp"
#include "resight/core/parallel.hpp"
#include "resight/core/random.hpp"
#include "resight/simulation/internal/scene_state.hpp"

namespace resight {
namespace {

using Role = SimulatedInstance::Role;

// One of the two patterns that the tools of V4R understand. It also sorts correctly beyond 100 views.
std::string view_name(int view) {
  char name[32];
  std::snprintf(name, sizeof name, "%05d", view);
  return name;
}

// Pixels of an object rendered alone, within the image and within a canvas of 3 x 3 images around it.
struct Silhouette {
  std::size_t in_image = 0;
  std::size_t in_canvas = 0;
};

struct PixelBox {
  int u0, v0, u1, v1;  // inclusive
};

PixelBox silhouette_box(const TriangleMesh& mesh, const Camera& camera, const Rigid3& camera_from_object) {
  const PixelBox canvas{-camera.width, -camera.height, 2 * camera.width - 1, 2 * camera.height - 1};
  Eigen::Array2d low(canvas.u1, canvas.v1);
  Eigen::Array2d high(canvas.u0, canvas.v0);
  for (const auto& v : mesh.vertices) {
    const Eigen::Vector3d p = camera_from_object * v.cast<double>().eval();
    if (p.z() <= 1e-3) return canvas;  // partly behind the camera: no bound
    const Eigen::Array2d pixel = camera.project(p).array();
    low = low.min(pixel);
    high = high.max(pixel);
  }
  const auto clamp_u = [&](double u) { return static_cast<int>(std::clamp<double>(u, canvas.u0, canvas.u1)); };
  const auto clamp_v = [&](double v) { return static_cast<int>(std::clamp<double>(v, canvas.v0, canvas.v1)); };
  return {clamp_u(std::floor(low.x())), clamp_v(std::floor(low.y())), clamp_u(std::ceil(high.x())),
          clamp_v(std::ceil(high.y()))};
}

Silhouette count_silhouette(const RaycastScene& alone, const Camera& camera, const Rigid3& camera_from_object) {
  const PixelBox box = silhouette_box(alone.mesh(0), camera, camera_from_object);
  const Rigid3f object_from_camera(camera_from_object.inverse());
  Silhouette count;
  std::vector<Ray> rays(static_cast<std::size_t>(std::max(0, box.u1 - box.u0 + 1)));
  std::vector<RayHit> hits(rays.size());
  for (int v = box.v0; v <= box.v1; ++v) {
    for (int u = box.u0; u <= box.u1; ++u)
      rays[u - box.u0] = pixel_ray(camera, object_from_camera, static_cast<float>(u), static_cast<float>(v));
    alone.cast(rays, hits);
    for (int u = box.u0; u <= box.u1; ++u) {
      if (!hits[u - box.u0].has_hit()) continue;
      ++count.in_canvas;
      if (u >= 0 && v >= 0 && u < camera.width && v < camera.height) ++count.in_image;
    }
  }
  return count;
}

}  // namespace

struct Simulation::Impl {
  SceneState state;
  std::uint64_t seed = 0;
  SimulationOptions options;
  RaycastScene scene;
  std::vector<RaycastScene> alone;  // each known object alone, for its silhouette

  void build_scenes() {
    std::map<const TriangleMesh*, int> mesh_ids;
    for (std::size_t i = 0; i < state.meshes.size(); ++i) {
      const auto [entry, is_new] = mesh_ids.try_emplace(state.meshes[i].get(), 0);
      if (is_new) entry->second = scene.add_mesh(state.meshes[i]);
      scene.set_material(scene.add_instance(entry->second, Rigid3::identity()), state.materials[i]);
    }
    for (const ProceduralObject& object : state.library) {
      alone.emplace_back();
      alone.back().add_instance(alone.back().add_mesh(object.mesh), Rigid3::identity());
      alone.back().commit();
    }
  }

  void pose_scene(int view) {
    for (std::size_t i = 0; i < state.instances.size(); ++i) {
      const std::optional<Rigid3>& pose = state.poses[view][i];
      scene.set_visible(static_cast<int>(i), pose.has_value());
      if (pose) scene.set_pose(static_cast<int>(i), *pose);
    }
    scene.commit();
  }

  void annotate(int view, SimulatedView& result) const {
    const Camera& camera = state.script.camera;
    const Rigid3 camera_from_world = state.script.world_from_camera[view].inverse();
    const std::size_t count = state.instances.size();
    std::vector<std::size_t> visible(count, 0);
    for (const int label : result.labels.data())
      if (label >= 0) ++visible[label];
    std::vector<Silhouette> silhouettes(count);
    parallel_for(count, options.num_threads, [&](std::size_t i) {
      const SimulatedInstance& instance = state.instances[i];
      if (instance.role != Role::kKnown || !state.poses[view][i]) return;
      silhouettes[i] = count_silhouette(alone[instance.object], camera, camera_from_world * *state.poses[view][i]);
    });
    std::map<std::string, int> numbers;
    for (std::size_t i = 0; i < count; ++i) {
      if (silhouettes[i].in_image == 0) continue;
      const SimulatedInstance& instance = state.instances[i];
      // A ray through a shared edge may hit either side, so the share is clamped.
      const double share =
          std::min(1.0, static_cast<double>(visible[i]) / static_cast<double>(silhouettes[i].in_canvas));
      result.ground_truth.push_back({instance.model, instance.object + 1, numbers[instance.model]++,
                                     camera_from_world * *state.poses[view][i], share});
      result.ground_truth_instances.push_back(static_cast<int>(i));
    }
  }
};

void SimulationOptions::check() const {
  check_in_range("SimulationOptions.samples_per_side", samples_per_side, 1, 8);
  check_in_range("SimulationOptions.num_threads", num_threads, 1, 4096);
}

Simulation::Simulation(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
Simulation::~Simulation() = default;
Simulation::Simulation(Simulation&&) noexcept = default;
Simulation& Simulation::operator=(Simulation&&) noexcept = default;

Result<Simulation> Simulation::create(SceneScript script, std::uint64_t seed, const SimulationOptions& options) {
  options.check();
  script.sensor.check();
  script.lighting.check();
  script.color_lens.check();
  auto state = build_scene_state(std::move(script), seed);
  if (!state) return state.error();
  auto impl = std::make_unique<Impl>();
  impl->state = std::move(*state);
  impl->seed = seed;
  impl->options = options;
  impl->build_scenes();
  return Simulation(std::move(impl));
}

const SceneScript& Simulation::script() const { return impl_->state.script; }
int Simulation::num_views() const { return static_cast<int>(impl_->state.poses.size()); }
const std::vector<SimulatedInstance>& Simulation::instances() const { return impl_->state.instances; }
const std::vector<ProceduralObject>& Simulation::library() const { return impl_->state.library; }
const std::vector<ProceduralObject>& Simulation::unknown_objects() const { return impl_->state.unknown_objects; }
const std::vector<ScriptedEvent>& Simulation::events() const { return impl_->state.events; }

const std::optional<Rigid3>& Simulation::world_from_instance(int instance, int view) const {
  require(view >= 0 && view < num_views(), "Simulation: no view " + std::to_string(view));
  require(instance >= 0 && instance < static_cast<int>(instances().size()),
          "Simulation: no instance " + std::to_string(instance));
  return impl_->state.poses[view][instance];
}

int Simulation::placement_number(int instance, int view) const {
  static_cast<void>(world_from_instance(instance, view));
  return impl_->state.placements[view][instance];
}

SimulatedView Simulation::render_view(int view) {
  require(view >= 0 && view < num_views(), "Simulation::render_view: no view " + std::to_string(view));
  const SceneScript& script = impl_->state.script;
  const Rigid3& world_from_camera = script.world_from_camera[view];
  impl_->pose_scene(view);
  RenderOptions render;
  render.samples_per_side = impl_->options.samples_per_side;
  render.lighting = script.lighting;
  render.linear_light = script.sensor.color_camera.has_value();
  if (!script.sensor.noise_free) render.color_lens = script.color_lens;
  render.num_threads = impl_->options.num_threads;
  RenderedView rendered = render_scene(impl_->scene, script.camera, world_from_camera, render);

  SimulatedView result;
  const std::uint64_t view_seed = Rng::stream(impl_->seed, static_cast<std::uint64_t>(view)).next();
  result.frame.name = view_name(view);
  result.frame.camera = script.camera;
  result.frame.world_from_camera = reported_pose(script, view);
  result.frame.depth_m = sense_depth(impl_->scene, script.camera, world_from_camera, rendered, script.sensor, view_seed,
                                     render.num_threads);
  result.frame.color = sense_color(rendered, script.sensor, view_seed, render.num_threads);
  result.labels = std::move(rendered.labels);
  impl_->annotate(view, result);
  for (const ScriptedEvent& event : events())
    if (event.view == view) result.events.push_back(event);
  return result;
}

}  // namespace resight
