// SPDX-License-Identifier: Apache-2.0
#include "resight/modelling/internal/object_edges.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "resight/core/parallel.hpp"
#include "resight/core/statistics.hpp"
#include "resight/registration/twist.hpp"

namespace resight {
namespace {

using Eigen::Vector3d;

// Residual error of the sensor's bias between any two views, independent of the number of agreeing pixels.
constexpr double kFloorSigma_m = 0.0007;
constexpr double kFloorSigma_rad = 0.003;
constexpr int kPixelStep = 9;  // Sampling step on the surface on which errors are measured.

TwistMatrix edge_information(const TwistMatrix& information) {
  return limit_information(information, 1, kFloorSigma_rad, kFloorSigma_m);
}

TwistMatrix match_information(const TrackObjectOptions& options) {
  return twist_information(options.features.sigma_rad, options.features.sigma_m);
}

const Rigid3& pose_of(const TrainingView& view) { return view.frame.world_from_camera; }

std::optional<PoseEdge> measure_edge(std::span<const Rigid3> poses, std::span<const TrackView> parts, int a, int b,
                                     StartKind kind, const TrackObjectOptions& options) {
  std::vector<AlignmentStart> starts{{poses[b], kind}};
  const std::optional<ViewMatch> match = match_views(parts[a].features, parts[b].features, options.features.match);
  // The lit side of a plain object on a turntable stays where it is: its matches say that the object does not turn.
  if (match && !(kind == StartKind::kGiven && contradicts(poses[a] * match->a_from_b, poses[b], kMatchSigmas, options)))
    starts.push_back({poses[a] * match->a_from_b, StartKind::kMatched});
  const std::vector<AlignmentTarget> target{{&parts[a].alignment, poses[a]}};
  std::optional<AlignedView> best;
  for (const AlignmentStart& start : starts) {
    AlignViewOptions align = align_options(options, start.kind);
    align.num_threads = 1;  // Pairs are measured in parallel.
    AlignedView aligned = align_view(parts[b].alignment, target, start.pose, align);
    if (!is_plausible(aligned, options) || (best && alignment_score(aligned) <= alignment_score(*best))) continue;
    if (start.kind == StartKind::kMatched) aligned.information += match_information(options);
    best = aligned;
  }
  if (!best) return std::nullopt;
  return PoseEdge{a, b, poses[a].inverse() * best->world_from_camera, edge_information(best->information)};
}

// Mean displacement of the object points that `view` observes; NaN if it observes none.
double surface_shift_m(const TrainingView& view, const Rigid3& motion_of_object) {
  double sum = 0;
  int num = 0;
  for (int v = 0; v < view.mask.height(); v += kPixelStep)
    for (int u = 0; u < view.mask.width(); u += kPixelStep) {
      if (view.mask(u, v) == 0 || std::isnan(view.frame.depth_m(u, v))) continue;
      const Vector3d p = pose_of(view) * view.frame.camera.unproject(u, v, view.frame.depth_m(u, v));
      sum += (motion_of_object * p - p).norm();
      ++num;
    }
  return num == 0 ? std::numeric_limits<double>::quiet_NaN() : sum / num;
}

}  // namespace

bool contradicts(const Rigid3& pose, const Rigid3& given, double sigmas, const TrackObjectOptions& options) {
  const Rigid3 difference = given.inverse() * pose;
  return difference.translation.norm() > sigmas * std::hypot(options.given.sigma_m, options.features.sigma_m) ||
         rotation_angle_rad(difference.rotation, Eigen::Matrix3d::Identity()) >
             sigmas * std::hypot(options.given.sigma_rad, options.features.sigma_rad);
}

AlignViewOptions align_options(const TrackObjectOptions& options, StartKind kind) {
  AlignViewOptions align = options.align;
  align.num_threads = options.num_threads;
  if (kind == StartKind::kGuess) return align;
  const bool is_given = kind == StartKind::kGiven;
  align.prior_sigma_m = is_given ? options.given.sigma_m : options.features.sigma_m;
  align.prior_sigma_rad = is_given ? options.given.sigma_rad : options.features.sigma_rad;
  return align;
}

bool is_plausible(const AlignedView& aligned, const TrackObjectOptions& options) {
  return aligned.overlap >= options.plausible.min_overlap &&
         aligned.seen_through <= options.plausible.max_seen_through &&
         !(aligned.brightness_correlation < options.plausible.min_correlation);
}

double alignment_score(const AlignedView& aligned) {
  const double likeness = std::isnan(aligned.brightness_correlation) ? 0 : aligned.brightness_correlation;
  return aligned.overlap - 2 * aligned.seen_through + likeness;
}

std::vector<PoseEdge> measure_edges(std::span<const Rigid3> object_from_camera, std::span<const TrackView> parts,
                                    std::span<const std::pair<int, int>> pairs, StartKind kind,
                                    const TrackObjectOptions& options) {
  std::vector<std::optional<PoseEdge>> measured(pairs.size());
  parallel_for(pairs.size(), options.num_threads, [&](std::size_t p) {
    measured[p] = measure_edge(object_from_camera, parts, pairs[p].first, pairs[p].second, kind, options);
  });
  std::vector<PoseEdge> edges;
  for (const auto& edge : measured)
    if (edge) edges.push_back(*edge);
  return edges;
}

double median_error_m(std::span<const TrainingView> views, std::span<const PoseEdge> edges) {
  std::vector<double> errors;
  for (const PoseEdge& e : edges)
    errors.push_back(surface_shift_m(views[e.b], pose_of(views[e.a]) * e.a_from_b * pose_of(views[e.b]).inverse()));
  std::erase_if(errors, [](double error_m) { return std::isnan(error_m); });
  return upper_median(std::move(errors));
}

double measure_closure(std::span<const TrainingView> views, std::span<const std::pair<int, int>> loops, StartKind kind,
                       const TrackObjectOptions& options) {
  std::vector<int> used;
  for (const auto& [a, b] : loops) used.insert(used.end(), {a, b});
  std::ranges::sort(used);
  used.erase(std::unique(used.begin(), used.end()), used.end());
  std::vector<Rigid3> poses;
  for (const int view : used) poses.push_back(pose_of(views[view]));
  const auto place = [&](int view) { return static_cast<int>(std::ranges::lower_bound(used, view) - used.begin()); };
  std::vector<std::pair<int, int>> pairs;
  for (const auto& [a, b] : loops) pairs.emplace_back(place(a), place(b));
  std::vector<PoseEdge> edges = measure_edges(poses, make_track_views(views, used, options), pairs, kind, options);
  for (PoseEdge& edge : edges) {
    edge.a = used[edge.a];
    edge.b = used[edge.b];
  }
  return median_error_m(views, edges);
}

}  // namespace resight
