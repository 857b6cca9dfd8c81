// SPDX-License-Identifier: Apache-2.0
// Camera poses from the views alone, against those of the sequence. One line a view, then the trajectory's error.
//   bench_track_views SEQUENCE [every n-th view]
#include <fmt/format.h>

#include <cstdlib>
#include <vector>

#include "arguments.hpp"
#include "resight/cameras/trajectory_error.hpp"
#include "resight/cameras/view_tracker.hpp"
#include "resight/core/timing.hpp"
#include "resight/io/sequence.hpp"

namespace {

using namespace resight;
constexpr double kDegPerRad = 57.29578;

void print_error(const char* name, std::span<const Rigid3> truth, std::span<const Rigid3> poses) {
  const TrajectoryError e = find_trajectory_error(truth, poses);
  fmt::print("{}: {} views, ATE {:.2f} mm rms, {:.2f} mm at most; {:.3f} deg mean, {:.3f} at most\n", name, e.num_views,
             1000 * e.rms_m, 1000 * e.max_m, kDegPerRad * e.mean_rad, kDegPerRad * e.max_rad);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2) exit_with("usage: bench_track_views SEQUENCE [every n-th view]");
  const auto sequence = value_or_exit(open_sequence(argv[1]));
  const int step = argc > 2 ? std::atoi(argv[2]) : 1;
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
    fmt::print("{} part {} {} matches {} overlap {:.2f} sigma {:.1f} mm {:.2f} deg\n", t.name, t.part,
               t.is_keyframe ? "key" : "   ", t.num_matches, t.overlap, 1000 * t.sigma.tail<3>().maxCoeff(),
               kDegPerRad * t.sigma.head<3>().maxCoeff());
  }
  CameraTrack track;
  {
    const ScopedTimer timer(times, "finish");
    track = tracker.finish();
  }
  for (int part = 0; part < track.num_parts; ++part) {
    std::vector<Rigid3> of_part, true_of_part;
    for (std::size_t v = 0; v < truth.size(); ++v) {
      if (track.views[v].part != part) continue;
      of_part.push_back(track.views[v].world_from_camera);
      true_of_part.push_back(truth[v]);
    }
    print_error(fmt::format("part {}", part).c_str(), true_of_part, of_part);
    const Rigid3 moved = find_trajectory_error(true_of_part, of_part).reference_from_estimate;
    for (std::size_t v = 0; v < of_part.size(); ++v)
      fmt::print(" {:.0f}", 1000 * ((moved * of_part[v]).translation - true_of_part[v].translation).norm());
    fmt::print(" mm\n");
  }
  fmt::print("{} edges, {} loops; ", track.edges.size(), track.num_loops);
  for (const StageTime& t : times.stages()) fmt::print("{} {:.2f} s  ", t.stage, t.wall_s);
  fmt::print("\n");
  return 0;
}
