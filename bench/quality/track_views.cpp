// SPDX-License-Identifier: Apache-2.0
// Camera poses from the views alone, compared with those of the sequence. Prints one line per view, then the error of
// the trajectory and the edges that are wrong. With a library (and every view), also after the joint adjustment of
// objects and cameras, and the errors of the objects before (each observation alone) and after it.
//   bench_track_views SEQUENCE [every n-th view] [LIBRARY]
#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <span>
#include <vector>

#include "arguments.hpp"
#include "resight/cameras/joint_adjustment.hpp"
#include "resight/cameras/trajectory_error.hpp"
#include "resight/cameras/view_tracker.hpp"
#include "resight/core/timing.hpp"
#include "resight/io/sequence.hpp"
#include "resight/models/library_file.hpp"
#include "resight/recognition/observe_objects.hpp"

namespace {

using namespace resight;
constexpr double kDegPerRad = 57.29578;

void print_error(const char* name, std::span<const Rigid3> truth, std::span<const Rigid3> poses) {
  const TrajectoryError e = find_trajectory_error(truth, poses);
  fmt::print("{}: {} views, ATE {:.2f} mm rms, {:.2f} mm max; {:.3f} deg mean, {:.3f} deg max\n", name, e.num_views,
             1000 * e.rms_m, 1000 * e.max_m, kDegPerRad * e.mean_rad, kDegPerRad * e.max_rad);
}

struct Observation {
  int view = 0;
  int object = -1;
  Rigid3 camera_from_object;
};

// Compares with the nearest true object of the same name. Objects farther than 5 cm are no errors of the pose.
void print_object_error(const char* name, const Sequence& sequence, const ModelLibrary& library,
                        const std::vector<Observation>& observations) {
  std::vector<double> errors_m, errors_rad;
  for (const Observation& observation : observations) {
    const ObjectModel& model = library.objects[static_cast<std::size_t>(observation.object)];
    for (const GroundTruthObject& truth : value_or_exit(sequence.read_ground_truth(observation.view))) {
      const Rigid3& true_pose = truth.camera_from_object;
      const Eigen::Vector3d center = model.center.cast<double>();
      const double off = (true_pose * center - observation.camera_from_object * center).norm();
      if (truth.object != model.name || off > 0.05) continue;
      errors_m.push_back(off);
      errors_rad.push_back(
          symmetric_rotation_distance_rad(true_pose, observation.camera_from_object, model.symmetries));
    }
  }
  if (errors_m.empty()) return;
  std::ranges::sort(errors_m);
  std::ranges::sort(errors_rad);
  const auto at = [](const std::vector<double>& e, double share) {
    return e[static_cast<std::size_t>(share * static_cast<double>(e.size() - 1))];
  };
  fmt::print("{}: {} observations, centre {:.2f} mm median, {:.2f} mm at 95 %; {:.2f} deg median, {:.2f} at 95 %\n",
             name, errors_m.size(), 1000 * at(errors_m, 0.5), 1000 * at(errors_m, 0.95),
             kDegPerRad * at(errors_rad, 0.5), kDegPerRad * at(errors_rad, 0.95));
}

void print_joint_adjustment(const Sequence& sequence, const ModelLibrary& library, const CameraTrack& track,
                            std::span<const Rigid3> truth) {
  const std::vector<ObservedObject> observed = value_or_exit(observe_objects(sequence, library, 2));
  std::vector<Observation> before, after;
  const auto [adjusted, objects] = adjust_jointly(track, observed, library);
  for (const StaticObject& object : objects)
    for (const int v : object.views) {
      const Rigid3& camera = adjusted.views[static_cast<std::size_t>(v)].world_from_camera;
      after.push_back({v, object.object, camera.inverse() * object.world_from_object});
      for (const ObservedObject& o : observed) {
        if (o.view != v || o.object != object.object) continue;
        if (((o.camera_from_object.translation - after.back().camera_from_object.translation).norm()) < 0.1)
          before.push_back({v, o.object, o.camera_from_object});
      }
    }
  std::vector<Rigid3> poses;
  for (const TrackedView& view : adjusted.views) poses.push_back(view.world_from_camera);
  print_error(fmt::format("with {} objects", objects.size()).c_str(), truth, poses);
  print_object_error("objects, one view each", sequence, library, before);
  print_object_error("objects, adjusted", sequence, library, after);
}

// Edges between views that are farther off than any drift.
void print_wrong_edges(const CameraTrack& track, std::span<const Rigid3> truth) {
  constexpr double kWrong_m = 0.1;
  constexpr double kWrong_rad = 0.1;
  int num_wrong = 0;
  for (const PoseEdge& e : track.edges) {
    const Rigid3 true_a_from_b = truth[static_cast<std::size_t>(e.a)].inverse() * truth[static_cast<std::size_t>(e.b)];
    const double off_m = (e.a_from_b.translation - true_a_from_b.translation).norm();
    const double off_rad = rotation_angle_rad(e.a_from_b.rotation, true_a_from_b.rotation);
    if (off_m < kWrong_m && off_rad < kWrong_rad) continue;
    ++num_wrong;
    fmt::print("wrong: {} to {}, {:.0f} mm, {:.1f} deg\n", track.views[static_cast<std::size_t>(e.a)].name,
               track.views[static_cast<std::size_t>(e.b)].name, 1000 * off_m, kDegPerRad * off_rad);
  }
  fmt::print("{} wrong edges; ", num_wrong);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2) exit_with("usage: bench_track_views SEQUENCE [every n-th view] [LIBRARY]");
  const auto sequence = value_or_exit(open_sequence(argv[1]));
  const int step = argc > 2 ? std::max(1, std::atoi(argv[2])) : 1;
  TrackViewsOptions options;
  options.num_threads = 2;
  ViewTracker tracker(options);
  std::vector<Rigid3> truth;
  StageTimes times;
  for (int v = 0; v < sequence->num_views(); v += step) {
    const PreparedView view = prepare_view(value_or_exit(sequence->read_view(v)));
    truth.push_back(view.frame.world_from_camera);
    const ScopedTimer timer(times, "track");
    const TrackedView t = tracker.add_view(view);
    fmt::print("{} component {} {} matches {} overlap {:.2f} sigma {:.1f} mm {:.2f} deg\n", t.name, t.component,
               t.is_keyframe ? "key" : "   ", t.num_matches, t.overlap, 1000 * t.sigma.tail<3>().maxCoeff(),
               kDegPerRad * t.sigma.head<3>().maxCoeff());
  }
  CameraTrack track;
  {
    const ScopedTimer timer(times, "finish");
    track = tracker.finish();
  }
  for (int component = 0; component < track.num_components; ++component) {
    std::vector<Rigid3> of_component, true_of_component;
    for (std::size_t v = 0; v < truth.size(); ++v) {
      if (track.views[v].component != component) continue;
      of_component.push_back(track.views[v].world_from_camera);
      true_of_component.push_back(truth[v]);
    }
    print_error(fmt::format("component {}", component).c_str(), true_of_component, of_component);
    const Rigid3 moved = find_trajectory_error(true_of_component, of_component).reference_from_estimate;
    for (std::size_t v = 0; v < of_component.size(); ++v)
      fmt::print(" {:.0f}", 1000 * ((moved * of_component[v]).translation - true_of_component[v].translation).norm());
    fmt::print(" mm\n");
  }
  print_wrong_edges(track, truth);
  fmt::print("{} edges, {} long ones; ", track.edges.size(), track.num_long_edges);
  for (const StageTime& t : times.stages()) fmt::print("{} {:.2f} s  ", t.stage, t.wall_s);
  fmt::print("\n");
  if (argc > 3 && step == 1) print_joint_adjustment(*sequence, value_or_exit(load_library(argv[3])), track, truth);
  return 0;
}
