// SPDX-License-Identifier: Apache-2.0
// Accuracy of object models built from recordings: both sides of generated objects on a turntable, 36 views each, with
// sensor noise, compared with the generated meshes. --true-poses skips tracking and joining and tests fusion alone. The
// models in --out are in the frames of the meshes, so that both results can be compared. --tabletop records the objects
// of dynamic-tabletop version 3 that are to be recorded, with the device and the light of that seed. --given gives
// poses with so many mm, and mrad, of independent noise; --one-side leaves the other side out; --or-one-side does so
// only if the sides cannot be joined. Returns 1 if an object has no model.
//   bench_model_objects [--true-poses | --given MM] [--one-side | --or-one-side] [--walk] [--tabletop SEED] [--out DIR]
//     [OBJECT...]
#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "resight/cameras/trajectory_error.hpp"
#include "resight/core/parallel.hpp"
#include "resight/core/random.hpp"
#include "resight/modelling/build_model.hpp"
#include "resight/modelling/surface_error_test_util.hpp"
#include "resight/modelling/track_object.hpp"
#include "resight/modelling/write_model.hpp"
#include "resight/registration/point_to_plane.hpp"
#include "resight/registration/twist.hpp"
#include "resight/simulation/scene_script.hpp"
#include "resight/simulation/tabletop_library.hpp"

namespace {

using namespace resight;  // NOLINT(google-build-using-namespace)

const std::vector<std::string> kObjects{"cereal_red",  "tea_box",    "milk_carton", "novel",
                                        "soup_tomato", "coffee_tin", "ketchup",     "detergent",
                                        "mug",         "toy_car",    "toy_house",   "duck"};

struct Plan {
  bool true_poses = false;
  std::optional<double> given_noise_mm;
  bool one_side = false;
  bool or_one_side = false;
  RecordingKind kind = RecordingKind::kTurntable;
  std::filesystem::path out;
  std::optional<std::uint64_t> tabletop_seed;
  std::vector<std::string> names;
};

RecordingOptions recording_options(const ProceduralObject& object, const Plan& plan) {
  RecordingOptions options;
  if (plan.tabletop_seed)
    for (const TabletopModel& model : tabletop_models(*plan.tabletop_seed))
      if (model.name == object.name) options = tabletop_recording_options(*plan.tabletop_seed, model);
  options.kind = plan.kind;
  options.material = object.material;
  options.num_threads = num_hardware_threads();
  return options;
}

struct Side {
  std::vector<RgbdFrame> frames;
  std::vector<Rigid3> object_from_camera;
};

void give_poses(double noise_mm, Side& side) {
  Rng rng(1);
  for (std::size_t i = 0; i < side.frames.size(); ++i) {
    Twist off;
    for (double& component : off) component = 0.001 * noise_mm * rng.normal();
    side.frames[i].world_from_camera = side.object_from_camera[i] * from_twist(off);
  }
}

Side record(const ProceduralObject& object, const Plan& plan, bool upside_down) {
  RecordingOptions options = recording_options(object, plan);
  options.upside_down = upside_down;
  Side side;
  for (RecordedView& view : simulate_recording(object.mesh, options)) {
    side.frames.push_back(std::move(view.frame));
    side.object_from_camera.push_back(view.camera_from_object.inverse());
  }
  if (plan.given_noise_mm) give_poses(*plan.given_noise_mm, side);
  return side;
}

// Masks are found, not given: the region of the first view applies to all, because a turntable's camera is static.
Result<ObjectTrack> mask_with_true_poses(Side side) {
  ObjectTrack track;
  std::optional<ObjectRegion> region;
  for (std::size_t i = 0; i < side.frames.size(); ++i) {
    PreparedView view = prepare_view(std::move(side.frames[i]));
    if (!region) region = find_object_region(view);
    if (!region) return Error{"no object stands on a support"};
    Image<std::uint8_t> mask = segment_object(view.cloud, *region);
    view.frame.world_from_camera = side.object_from_camera[i];
    track.views.push_back({std::move(view.frame), std::move(mask)});
  }
  return track;
}

Result<ObjectTrack> track_both(const ProceduralObject& object, const Plan& plan, std::vector<Rigid3>& truth) {
  TrackObjectOptions options;
  options.num_threads = num_hardware_threads();
  std::vector<ObjectTrack> tracks;
  for (const bool upside_down : {false, true}) {
    if (upside_down && plan.one_side) return std::move(tracks[0]);
    Side side = record(object, plan, upside_down);
    truth.insert(truth.end(), side.object_from_camera.begin(), side.object_from_camera.end());
    auto track =
        plan.true_poses ? mask_with_true_poses(std::move(side)) : track_object(std::move(side.frames), options);
    if (!track && !(upside_down && plan.or_one_side)) return track;
    if (track) tracks.push_back(std::move(*track));
  }
  const std::size_t num_first_views = tracks[0].views.size();
  if (plan.true_poses && tracks.size() == 2) {
    for (TrainingView& view : tracks[1].views) tracks[0].views.push_back(std::move(view));
    return std::move(tracks[0]);
  }
  std::optional<ObjectTrack> first;
  if (plan.or_one_side) first = tracks[0];
  if (tracks.size() == 2) {
    auto joined = join_tracks(std::move(tracks[0]), std::move(tracks[1]), options);
    if (joined || !first) return joined;
  }
  truth.resize(num_first_views);
  return std::move(*first);
}

// A model has its own frame. This aligns it to the true surface (point to plane).
Rigid3 fit_to_truth(const TriangleMesh& mesh, const TriangleMesh& truth, Rigid3 truth_from_model) {
  const PointCloud surface = sample_visible_surface(truth, 0.0015);
  const KdTree tree(surface.points);
  for (int round = 0; round < 15; ++round) {
    NormalEquations equations{.matrix = 1e-6 * Matrix6::Identity()};
    for (std::size_t i = 0; i < mesh.vertices.size(); i += 7) {
      const Eigen::Vector3d p = truth_from_model * mesh.vertices[i].cast<double>().eval();
      const PointNeighbor nearest = tree.nearest(p.cast<float>());
      if (nearest.distance_sq > 0.01F * 0.01F) continue;
      const Eigen::Vector3d normal = surface.normals[nearest.index].cast<double>();
      const Eigen::Vector3d offset = surface.points[nearest.index].cast<double>() - p;
      equations.add_row(point_to_plane_row(p, normal), normal.dot(offset));
    }
    truth_from_model = from_twist(equations.matrix.ldlt().solve(equations.right)) * truth_from_model;
  }
  return truth_from_model;
}

// Moves the model into the frame of the generated mesh.
void move_model(const Rigid3& truth_from_model, ObjectTrack& track, ObjectModelBuild& build) {
  const auto move = [](const Rigid3& by, std::vector<Eigen::Vector3f>& points) {
    for (Eigen::Vector3f& p : points) p = (by * p.cast<double>().eval()).cast<float>();
  };
  for (TrainingView& view : track.views) view.frame.world_from_camera = truth_from_model * view.frame.world_from_camera;
  move(truth_from_model, build.mesh.vertices);
  move(truth_from_model, build.cloud.points);
  move({truth_from_model.rotation, Eigen::Vector3d::Zero()}, build.cloud.normals);
}

// The same as the data set declares of the exact mesh, so that results of both can be scored alike.
DeclaredModelInfo declared_info(const ProceduralObject& object, const Plan& plan) {
  DeclaredModelInfo declared;
  declared.symmetries = object.symmetries;
  if (plan.tabletop_seed)
    for (const TabletopModel& model : tabletop_models(*plan.tabletop_seed))
      if (model.name == object.name) declared.bop_id = model.bop_id;
  return declared;
}

// Whether the object has a model, which is written if that was asked for.
bool measure(const std::string& name, const Plan& plan) {
  const auto object = make_script_object(plan.tabletop_seed, name);
  if (!object.ok()) {
    fmt::print("{}\n", object.error().message);
    return false;
  }
  const TriangleMesh& truth = object->mesh;
  std::vector<Rigid3> true_poses;
  const auto start = std::chrono::steady_clock::now();
  auto track = track_both(*object, plan, true_poses);
  if (!track) {
    fmt::print("{:12} {}\n", name, track.error().message);
    return false;
  }
  BuildModelOptions options;
  options.num_threads = num_hardware_threads();
  auto build = build_model(track->views, options);
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  if (!build) {
    fmt::print("{:12} {}\n", name, build.error().message);
    return false;
  }
  std::vector<Rigid3> poses;
  for (const TrainingView& view : track->views) poses.push_back(view.frame.world_from_camera);
  const TrajectoryError trajectory = find_trajectory_error(true_poses, poses);
  if (!plan.true_poses)
    move_model(fit_to_truth(build->mesh, truth, trajectory.reference_from_estimate), *track, *build);
  const test::SurfaceError error = test::measure_surface_error(build->mesh, truth);
  fmt::print("{:12} {:6} {:10.2f} {:9.2f} {:9.2f} {:9.2f} {:9.3f} {:6.3f} {:8.1f}\n", name, poses.size(),
             1000 * track->closure_error_m, trajectory.mean_rad * 57.29578, 1000 * error.median_m, 1000 * error.p95_m,
             error.completeness, build->report.holes.open_share, seconds);
  std::fflush(stdout);
  if (plan.out.empty()) return true;
  if (const auto done = write_object_model(plan.out / name, track->views, *build, declared_info(*object, plan));
      !done) {
    fmt::print("{}\n", done.error().message);
    return false;
  }
  return true;
}

std::vector<std::string> default_names(const Plan& plan) {
  if (!plan.tabletop_seed) return kObjects;
  std::vector<std::string> names;
  for (const TabletopModel& model : tabletop_models(*plan.tabletop_seed))
    if (model.origin == ModelOrigin::kRecording) names.push_back(model.name);
  return names;
}

}  // namespace

int main(int argc, char** argv) {
  Plan plan;
  for (int i = 1; i < argc; ++i) {
    const std::string_view argument = argv[i];
    if (argument == "--out" && i + 1 < argc) {
      plan.out = argv[++i];
    } else if (argument == "--given" && i + 1 < argc) {
      plan.given_noise_mm = std::strtod(argv[++i], nullptr);
    } else if (argument == "--tabletop" && i + 1 < argc) {
      plan.tabletop_seed = std::strtoull(argv[++i], nullptr, 10);
    } else if (argument == "--true-poses") {
      plan.true_poses = true;
    } else if (argument == "--one-side") {
      plan.one_side = true;
    } else if (argument == "--or-one-side") {
      plan.or_one_side = true;
    } else if (argument == "--walk") {
      plan.kind = RecordingKind::kWalk;
    } else {
      plan.names.emplace_back(argument);
    }
  }
  fmt::print("{:12} {:>6} {:>10} {:>9} {:>9} {:>9} {:>9} {:>6} {:>8}\n", "object", "views", "closure mm", "rot. deg",
             "median mm", "p95 mm", "complete", "open", "seconds");
  bool is_complete = true;
  for (const std::string& name : plan.names.empty() ? default_names(plan) : plan.names)
    is_complete = measure(name, plan) && is_complete;
  return is_complete ? 0 : 1;
}
