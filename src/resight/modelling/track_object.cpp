// SPDX-License-Identifier: Apache-2.0
#include "resight/modelling/track_object.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "resight/cameras/twist.hpp"
#include "resight/core/check.hpp"
#include "resight/core/parallel.hpp"
#include "resight/modelling/internal/track_view.hpp"

namespace resight {
namespace {

using Eigen::Vector3d;
using Matrix6 = Eigen::Matrix<double, 6, 6>;

// What the sensor's bias leaves between any two views, however many pixels agree.
constexpr double kFloorSigmaM = 0.0007;
constexpr double kFloorSigmaRad = 0.003;
constexpr double kStillDepthShare = 0.02;  // of z: a pixel that changes by less shows the same
constexpr int kMinSteps = 6;               // between two views whose edge closes a loop
constexpr std::size_t kMinMaskPixels = 150;
constexpr int kMinColumns = 160;  // fewer: nothing is left to align at half of the size

Matrix6 edge_information(const Matrix6& information) {
  Twist floor;
  floor << Vector3d::Constant(kFloorSigmaRad * kFloorSigmaRad), Vector3d::Constant(kFloorSigmaM * kFloorSigmaM);
  const Matrix6 covariance = (information + Matrix6::Identity()).inverse() + Matrix6(floor.asDiagonal());
  const Matrix6 inverse = covariance.inverse();
  return 0.5 * (inverse + inverse.transpose());
}

std::size_t count_set(const Image<std::uint8_t>& mask) {
  return mask.size() - static_cast<std::size_t>(std::ranges::count(mask.data(), 0));
}

// Share of the pixels beside the object, with depth in both, that show the same depth.
double still_share(const RgbdFrame& a, const RgbdFrame& b, const Image<std::uint8_t>& object) {
  std::size_t still = 0;
  std::size_t both = 0;
  for (std::size_t i = 0; i < object.size(); ++i) {
    if (object[i] != 0 || std::isnan(a.depth_m[i]) || std::isnan(b.depth_m[i])) continue;
    ++both;
    still += std::abs(a.depth_m[i] - b.depth_m[i]) <= kStillDepthShare * a.depth_m[i];
  }
  return both == 0 ? 0 : static_cast<double>(still) / static_cast<double>(both);
}

// z up from the support, the origin at the region's foot.
Rigid3 make_object_frame(const ObjectRegion& region_in_camera) {
  const Vector3d up = region_in_camera.plane.normal;
  const Vector3d side = up.cross(Vector3d::UnitZ()).normalized();
  Rigid3 camera_from_object;
  camera_from_object.rotation.col(0) = side;
  camera_from_object.rotation.col(1) = up.cross(side);
  camera_from_object.rotation.col(2) = up;
  camera_from_object.translation = region_in_camera.foot;
  return camera_from_object.inverse();
}

class ObjectTracker {
 public:
  explicit ObjectTracker(const TrackObjectOptions& options) : options_(options) {}

  Result<ObjectTrack> track(std::vector<RgbdFrame> frames) {
    if (auto done = segment(std::move(frames)); !done) return done.error();
    cut_out();
    track_.views[0].frame.world_from_camera = make_object_frame(first_region_);
    for (std::size_t i = 1; i < track_.views.size(); ++i)
      if (auto done = follow(i); !done) return done.error();
    close_loops();
    refine_on_model(track_.views, options_, options_.num_refinements);
    track_.closure_error_m = measure_closure();
    return std::move(track_);
  }

 private:
  [[nodiscard]] Rigid3& pose(std::size_t i) { return track_.views[i].frame.world_from_camera; }
  [[nodiscard]] const std::string& name(std::size_t i) const { return track_.views[i].frame.name; }

  // Masks of all views.
  Result<void> segment(std::vector<RgbdFrame> frames) {
    std::optional<ObjectRegion> region;
    for (std::size_t i = 0; i < frames.size(); ++i) {
      if (frames[i].camera.width < kMinColumns)
        return Error{fmt::format("view {}: is {} columns wide ({} or more were expected)", frames[i].name,
                                 frames[i].camera.width, kMinColumns)};
      const PreparedView view = prepare_view(std::move(frames[i]));
      if (i == 1)  // all others are like the first and the second
        track_.is_camera_still =
            still_share(track_.views[0].frame, view.frame, track_.views[0].mask) >= options_.min_still_share;
      if (!region || !track_.is_camera_still) {
        const ObjectRegion last = region.value_or(ObjectRegion{});
        std::optional<ObjectRegion> found = find_object_region(view, options_.region, region ? &last : nullptr);
        if (!found && !region)
          return Error{fmt::format("view {}: no object stands on a level surface near the middle of the image",
                                   view.frame.name)};
        if (found) region = found;
      }
      if (i == 0) first_region_ = *region;
      Image<std::uint8_t> mask = segment_object(view.cloud, *region, options_.segment);
      if (count_set(mask) < kMinMaskPixels)
        return Error{fmt::format("lost at view {}: nothing stands where the object was", view.frame.name)};
      track_.views.push_back({view.frame, std::move(mask)});
    }
    if (track_.views.size() < 2) return Error{"a recording must have at least two views"};
    return {};
  }

  void cut_out() {
    std::vector<std::optional<TrackView>> parts(track_.views.size());
    parallel_for(parts.size(), options_.num_threads,
                 [&](std::size_t i) { parts[i].emplace(make_track_view(track_.views[i], options_)); });
    for (std::optional<TrackView>& part : parts) parts_.push_back(std::move(*part));
  }

  // A start that features gave, which tell more of the turn of what is round than its surface does.
  struct Start {
    Rigid3 pose;
    bool is_matched = false;
  };

  [[nodiscard]] AlignViewOptions align_options(bool is_matched) const {
    AlignViewOptions align = options_.align;
    align.num_threads = options_.num_threads;
    if (is_matched) {
      align.prior_sigma_m = options_.match_sigma_m;
      align.prior_sigma_rad = options_.match_sigma_rad;
    }
    return align;
  }

  [[nodiscard]] Matrix6 match_information() const {
    Twist information;
    information << Vector3d::Constant(1 / (options_.match_sigma_rad * options_.match_sigma_rad)),
        Vector3d::Constant(1 / (options_.match_sigma_m * options_.match_sigma_m));
    return information.asDiagonal();
  }

  [[nodiscard]] AlignedView align(std::size_t i, const Start& start, std::size_t first_target) {
    std::vector<AlignmentTarget> targets;
    for (std::size_t k = first_target; k < i; ++k) targets.push_back({&parts_[k].alignment, pose(k)});
    return align_view(parts_[i].alignment, targets, start.pose, align_options(start.is_matched));
  }

  [[nodiscard]] bool is_plausible(const AlignedView& aligned) const {
    return aligned.overlap >= options_.min_overlap && aligned.seen_through <= options_.max_seen_through &&
           !(aligned.brightness_correlation < options_.min_correlation);
  }

  // From where its features put it, from the last motion on, and from where the last view was.
  Result<void> follow(std::size_t i) {
    std::vector<Start> starts;
    int num_matches = 0;
    for (std::size_t k = i; k-- > (i > 2 ? i - 2 : 0);) {
      const std::optional<ViewMatch> match = match_views(parts_[k].features, parts_[i].features, options_.match);
      if (!match) continue;
      num_matches = std::max(num_matches, match->num_inliers);
      starts.push_back({pose(k) * match->a_from_b, true});
    }
    if (i > 1) starts.push_back({pose(i - 1) * (pose(i - 2).inverse() * pose(i - 1)), false});
    starts.push_back({pose(i - 1), false});
    const auto num_targets = static_cast<std::size_t>(options_.num_targets);
    std::optional<AlignedView> best;
    for (const Start& start : starts) {
      const AlignedView aligned = align(i, start, i > num_targets ? i - num_targets : 0);
      if (is_plausible(aligned) && (!best || score(aligned) > score(*best))) best = aligned;
    }
    if (!best) return Error{fmt::format("lost at view {}: {} matches", name(i), num_matches)};
    pose(i) = best->world_from_camera;
    return {};
  }

  // Brightness tells most of the turn of what is round: pairs that agree in it count.
  [[nodiscard]] static double score(const AlignedView& a) {
    const double likeness = std::isnan(a.brightness_correlation) ? 0 : a.brightness_correlation;
    return a.overlap - 2 * a.seen_through + likeness;
  }

  [[nodiscard]] double angle_between(std::size_t a, std::size_t b) {
    const Vector3d middle(0, 0, 0.4 * first_region_.height_m);
    const Vector3d da = (pose(a).translation - middle).normalized();
    const Vector3d db = (pose(b).translation - middle).normalized();
    return std::acos(std::clamp(da.dot(db), -1.0, 1.0));
  }

  // The relative pose of two views by themselves.
  [[nodiscard]] std::optional<PoseEdge> measure_edge(std::size_t a, std::size_t b) {
    std::vector<Start> starts{{pose(b), false}};
    if (const auto match = match_views(parts_[a].features, parts_[b].features, options_.match))
      starts.push_back({pose(a) * match->a_from_b, true});
    const std::vector<AlignmentTarget> target{{&parts_[a].alignment, pose(a)}};
    std::optional<AlignedView> best;
    for (const Start& start : starts) {
      AlignViewOptions align = align_options(start.is_matched);
      align.num_threads = 1;  // pairs are measured side by side
      AlignedView aligned = align_view(parts_[b].alignment, target, start.pose, align);
      if (!is_plausible(aligned) || (best && score(aligned) <= score(*best))) continue;
      if (start.is_matched) aligned.information += match_information();
      best = aligned;
    }
    if (!best) return std::nullopt;
    return PoseEdge{static_cast<int>(a), static_cast<int>(b), pose(a).inverse() * best->world_from_camera,
                    edge_information(best->information)};
  }

  void close_loops() {
    std::vector<std::pair<std::size_t, std::size_t>> pairs;
    for (std::size_t b = 1; b < parts_.size(); ++b)
      for (std::size_t a = 0; a < b; ++a)
        if (b - a == 1 || angle_between(a, b) < options_.max_edge_angle_rad) pairs.emplace_back(a, b);
    std::vector<std::optional<PoseEdge>> measured(pairs.size());
    parallel_for(pairs.size(), options_.num_threads,
                 [&](std::size_t p) { measured[p] = measure_edge(pairs[p].first, pairs[p].second); });
    std::vector<PoseEdge> edges;
    for (const auto& edge : measured)
      if (edge) edges.push_back(*edge);
    for (const PoseEdge& edge : edges)
      if (edge.b - edge.a >= kMinSteps) loops_.push_back(edge);
    track_.num_loops = static_cast<int>(loops_.size());
    track_.drift_m = measure_closure();
    std::vector<Rigid3> poses;
    for (std::size_t i = 0; i < parts_.size(); ++i) poses.push_back(pose(i));
    const PoseGraph graph = adjust_pose_graph(std::move(poses), edges, options_.graph);
    for (std::size_t i = 0; i < parts_.size(); ++i) pose(i) = graph.world_from_node[i];
  }

  // Median over the loops of how far apart the two views put the object's surface.
  [[nodiscard]] double measure_closure() {
    if (loops_.empty()) return std::numeric_limits<double>::quiet_NaN();
    std::vector<double> errors;
    for (const PoseEdge& loop : loops_) {
      const Rigid3 off = pose(loop.a) * loop.a_from_b * pose(loop.b).inverse();
      double sum = 0;
      for (const Vector3d& p : surface_points()) sum += (off * p - p).norm();
      errors.push_back(sum / static_cast<double>(surface_points().size()));
    }
    std::ranges::sort(errors);
    return errors[errors.size() / 2];
  }

  // Corners of the box around what the first view shows.
  [[nodiscard]] const std::vector<Vector3d>& surface_points() {
    if (!corners_.empty()) return corners_;
    const double r = std::max(0.02, (first_region_.radius_m - 0.03) / 1.3);
    const double h = std::max(0.01, (first_region_.height_m - 0.02) / 1.2);
    for (const double x : {-r, r})
      for (const double z : {0.0, h}) {
        corners_.emplace_back(x, 0, z);
        corners_.emplace_back(0, x, z);
      }
    return corners_;
  }

  const TrackObjectOptions& options_;
  ObjectTrack track_;
  ObjectRegion first_region_;
  std::vector<TrackView> parts_;
  std::vector<PoseEdge> loops_;
  std::vector<Vector3d> corners_;
};

}  // namespace

void TrackObjectOptions::check() const {
  region.check();
  segment.check();
  sift.check();
  match.check();
  view.check();
  align.check();
  graph.check();
  check_positive("TrackObjectOptions.num_targets", num_targets);
  check_in_range("TrackObjectOptions.min_overlap", min_overlap, 0, 1);
  check_in_range("TrackObjectOptions.max_seen_through", max_seen_through, 0, 1);
  check_in_range("TrackObjectOptions.min_correlation", min_correlation, -1, 1);
  check_positive("TrackObjectOptions.match_sigma_m", match_sigma_m);
  check_positive("TrackObjectOptions.match_sigma_rad", match_sigma_rad);
  check_in_range("TrackObjectOptions.max_edge_angle_rad", max_edge_angle_rad, 0, std::numbers::pi);
  check_in_range("TrackObjectOptions.min_still_share", min_still_share, 0, 1);
  check_not_negative("TrackObjectOptions.num_refinements", num_refinements);
  check_positive("TrackObjectOptions.num_join_views", num_join_views);
  check_in_range("TrackObjectOptions.min_join_overlap", min_join_overlap, 0, 1);
  fuse.check();
  check_in_range("TrackObjectOptions.num_threads", num_threads, 1, 4096);
}

Result<ObjectTrack> track_object(std::vector<RgbdFrame> frames, const TrackObjectOptions& options) {
  options.check();
  return ObjectTracker(options).track(std::move(frames));
}

}  // namespace resight
