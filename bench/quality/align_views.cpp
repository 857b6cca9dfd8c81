// SPDX-License-Identifier: Apache-2.0
// How near align_view() brings a view with a perturbed pose to its true pose, aligned to the preceding views at their
// true poses. Prints one line per view, and the medians.
//   bench_align_views SEQUENCE [K] [error, mm] [error, deg]
#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <deque>
#include <vector>

#include "arguments.hpp"
#include "resight/core/random.hpp"
#include "resight/core/statistics.hpp"
#include "resight/core/timing.hpp"
#include "resight/io/sequence.hpp"
#include "resight/registration/view_alignment.hpp"

namespace {

using namespace resight;
constexpr double kDegPerRad = 57.29578;

struct PastView {
  AlignmentView view;
  Rigid3 world_from_camera;
};

Eigen::Vector3d random_direction(Rng& rng) {
  return Eigen::Vector3d{rng.normal(), rng.normal(), rng.normal()}.normalized();
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2) exit_with("usage: bench_align_views SEQUENCE [K] [error, mm] [error, deg]");
  const auto sequence = value_or_exit(open_sequence(argv[1]));
  const std::size_t num_previous = argc > 2 ? static_cast<std::size_t>(std::atoi(argv[2])) : 5;
  const double error_m = (argc > 3 ? std::atof(argv[3]) : 10) / 1000;
  const double error_rad = (argc > 4 ? std::atof(argv[4]) : 1) / kDegPerRad;
  AlignViewOptions options;
  options.prior_sigma_m = 0.02;
  options.prior_sigma_rad = 2 / kDegPerRad;
  options.num_threads = 2;
  std::deque<PastView> past;
  std::vector<double> errors_mm, errors_deg, pyramid_ms, align_ms;
  for (int v = 0; v < sequence->num_views(); ++v) {
    const PreparedView prepared = prepare_view(value_or_exit(sequence->read_view(v)));
    const Rigid3 truth = prepared.frame.world_from_camera;
    StageTimes times;
    PastView now{{}, truth};
    {
      const ScopedTimer timer(times, "pyramid");
      now.view = make_alignment_view(prepared);
    }
    Rng rng = Rng::stream(1, static_cast<std::uint64_t>(v));
    const Rigid3 given = truth * Rigid3{Rigid3::from_axis_angle(random_direction(rng), error_rad).rotation,
                                        error_m * random_direction(rng)};
    std::vector<AlignmentTarget> targets;
    for (const PastView& p : past) targets.push_back({&p.view, p.world_from_camera});
    AlignedView before, after;
    {
      const ScopedTimer timer(times, "align");
      after = align_view(now.view, targets, given, options);
    }
    before = evaluate_alignment(now.view, targets, given, options);
    const AlignedView at_truth = evaluate_alignment(now.view, targets, truth, options);
    const Rigid3 off = truth.inverse() * after.world_from_camera;
    if (!past.empty()) {
      errors_mm.push_back(1000 * off.translation.norm());
      errors_deg.push_back(rotation_angle_rad(off.rotation, Eigen::Matrix3d::Identity()) * kDegPerRad);
      for (const StageTime& t : times.stages()) (t.stage == "align" ? align_ms : pyramid_ms).push_back(1000 * t.wall_s);
      const Eigen::Matrix<double, 6, 6> covariance = after.information.inverse();
      fmt::print(
          "{:3} {:6.2f} mm {:5.3f} deg  (sd {:.2f} mm) overlap {:.2f} {:.2f} {:.2f}  in front {:.3f} {:.3f} {:.3f}  "
          "distance {:.2f} {:.2f} {:.2f} mm\n",
          v, errors_mm.back(), errors_deg.back(), 1000 * std::sqrt(covariance.bottomRightCorner<3, 3>().trace()),
          before.overlap, after.overlap, at_truth.overlap, before.seen_through, after.seen_through,
          at_truth.seen_through, 1000 * before.mean_distance_m, 1000 * after.mean_distance_m,
          1000 * at_truth.mean_distance_m);
    }
    past.push_back(std::move(now));
    if (past.size() > num_previous) past.pop_front();
  }
  if (errors_mm.empty()) exit_with("the sequence has no second view");
  fmt::print("median {:.2f} mm, {:.3f} deg; largest {:.2f} mm, {:.3f} deg; pyramid {:.1f} ms, alignment {:.1f} ms\n",
             upper_median(errors_mm), upper_median(errors_deg), *std::ranges::max_element(errors_mm),
             *std::ranges::max_element(errors_deg), upper_median(pyramid_ms), upper_median(align_ms));
  return 0;
}
