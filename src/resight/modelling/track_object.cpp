// SPDX-License-Identifier: Apache-2.0
#include "resight/modelling/track_object.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <optional>
#include <span>
#include <utility>

#include "resight/core/check.hpp"
#include "resight/core/statistics.hpp"
#include "resight/modelling/internal/object_edges.hpp"
#include "resight/registration/twist.hpp"

namespace resight {
namespace {

using Eigen::Vector3d;

constexpr double kStillDepthShare = 0.02;  // Share of z. A pixel whose depth changes by less is static.
constexpr std::size_t kMinMaskPixels = 150;
constexpr double kMaxDriftSigmas = 10;  // Of the track from given poses.
constexpr int kMinColumns = 160;        // Narrower images have nothing left to align at half resolution.

std::size_t count_set(const Image<std::uint8_t>& mask) {
  return mask.size() - static_cast<std::size_t>(std::ranges::count(mask.data(), 0));
}

// Share of the pixels beside the object, with depth in both, whose depth is equal.
double still_share(const Image<float>& depth_a_m, const Image<float>& depth_b_m, const Image<std::uint8_t>& object) {
  std::size_t still = 0;
  std::size_t both = 0;
  for (std::size_t i = 0; i < object.size(); ++i) {
    if (object[i] != 0 || std::isnan(depth_a_m[i]) || std::isnan(depth_b_m[i])) continue;
    ++both;
    still += std::abs(depth_a_m[i] - depth_b_m[i]) <= kStillDepthShare * depth_a_m[i];
  }
  return both == 0 ? 0 : static_cast<double>(still) / static_cast<double>(both);
}

// Whether most of five views, spread over the recording, see the surroundings at the depth of the first view. The
// second view alone does not tell: a hand-held camera moves little between two views, or starts to move later.
bool is_camera_static(const Image<float>& first_depth_m, std::span<const RgbdFrame> others,
                      const Image<std::uint8_t>& object, double min_share) {
  constexpr std::size_t kCompared = 5;
  std::vector<double> shares;
  for (std::size_t k = 0; k < kCompared; ++k)
    shares.push_back(still_share(first_depth_m, others[k * (others.size() - 1) / (kCompared - 1)].depth_m, object));
  return upper_median(std::move(shares)) >= min_share;
}

// z points up from the support; the origin is the foot of the region.
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

struct MatchedPose {
  Rigid3 pose;
  int num_matches = 0;
};

class ObjectTracker {
 public:
  ObjectTracker(const TrackObjectOptions& options, const TrackObjectProgress& progress)
      : options_(options), progress_(progress) {}

  Result<ObjectTrack> track(std::vector<RgbdFrame> frames) {
    if (auto done = segment(std::move(frames)); !done) return done.error();
    std::vector<int> all(track_.views.size());
    std::iota(all.begin(), all.end(), 0);
    parts_ = make_track_views(track_.views, all, options_);
    track_.views[0].frame.world_from_camera = make_object_frame(first_region_);
    for (std::size_t i = 0; i < track_.views.size(); ++i) {
      if (i > 0)
        if (auto done = follow(i); !done) return done.error();
      if (progress_) progress_(static_cast<int>(i) + 1, name(i));
    }
    close_loops();
    refine_on_model(track_.views, options_, options_.num_refinements);
    track_.closure_error_m = measure_closure(track_.views, track_.loops, kind_of_poses(), options_);
    return std::move(track_);
  }

 private:
  [[nodiscard]] Rigid3& pose(std::size_t i) { return track_.views[i].frame.world_from_camera; }
  [[nodiscard]] const std::string& name(std::size_t i) const { return track_.views[i].frame.name; }

  [[nodiscard]] bool has_given_poses() const {
    return std::ranges::any_of(given_, [&](const Rigid3& given) { return !is_same_pose(given, given_.front()); });
  }
  // Whether the track has followed the given poses to view i, but for its drift.
  [[nodiscard]] bool is_near_given(std::size_t i) {
    const Rigid3 expected = pose(0) * (given_.front().inverse() * given_[i]);
    return !contradicts(pose(i), expected, kMaxDriftSigmas, options_);
  }
  // The poses of something else than the object, such as a still camera, are near in few views.
  [[nodiscard]] StartKind kind_of_poses() const {
    return 2 * num_given_ >= track_.views.size() ? StartKind::kGiven : StartKind::kGuess;
  }

  // Masks of all views.
  Result<void> segment(std::vector<RgbdFrame> frames) {
    if (frames.size() < 2) return Error{"a recording must have at least two views"};
    for (const RgbdFrame& frame : frames) {
      const Camera& camera = frame.camera;
      if (camera.width != frames[0].camera.width || camera.height != frames[0].camera.height)
        return Error{
            fmt::format("view {}: is {}x{}, other than the first view", frame.name, camera.width, camera.height)};
      given_.push_back(frame.world_from_camera);
    }
    std::optional<ObjectRegion> region;
    for (std::size_t i = 0; i < frames.size(); ++i) {
      if (frames[i].camera.width < kMinColumns)
        return Error{fmt::format("view {}: is {} columns wide (expected {} or more)", frames[i].name,
                                 frames[i].camera.width, kMinColumns)};
      const PreparedView view = prepare_view(std::move(frames[i]));
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
      const bool is_lost = count_set(mask) < kMinMaskPixels;
      if (is_lost && track_.is_camera_still) {
        // A plain surface around the object looks still from all sides. The masks before lack parts of the object, too.
        track_.is_camera_still = false;
        frames[i] = view.frame;
        for (; track_.views.size() > 1; track_.views.pop_back())
          frames[track_.views.size() - 1] = std::move(track_.views.back().frame);
        region = first_region_;
        i = 0;  // Again from view 1.
        continue;
      }
      if (is_lost) return Error{fmt::format("lost at view {}: nothing stands where the object was", view.frame.name)};
      track_.views.push_back({view.frame, std::move(mask)});
      const TrainingView& first = track_.views[0];
      if (i == 0)
        track_.is_camera_still =
            is_camera_static(first.frame.depth_m, std::span(frames).subspan(1), first.mask, options_.min_still_share);
    }
    return {};
  }

  [[nodiscard]] AlignedView align(std::size_t i, const AlignmentStart& start, std::size_t first_target) {
    std::vector<AlignmentTarget> targets;
    for (std::size_t k = first_target; k < i; ++k) targets.push_back({&parts_[k].alignment, pose(k)});
    return align_view(parts_[i].alignment, targets, start.pose, align_options(options_, start.kind));
  }

  // The best plausible alignment; none if the object is lost.
  [[nodiscard]] std::optional<AlignedView> align_from(std::size_t i, std::span<const AlignmentStart> starts) {
    const auto num_targets = static_cast<std::size_t>(options_.num_targets);
    std::optional<AlignedView> best;
    for (const AlignmentStart& start : starts) {
      const AlignedView aligned = align(i, start, i > num_targets ? i - num_targets : 0);
      if (is_plausible(aligned, options_) && (!best || alignment_score(aligned) > alignment_score(*best)))
        best = aligned;
    }
    return best;
  }

  // Poses of view i from matches with its two predecessors.
  [[nodiscard]] std::vector<MatchedPose> match(std::size_t i) {
    std::vector<MatchedPose> matched;
    for (std::size_t k = i; k-- > (i > 2 ? i - 2 : 0);)
      if (const auto found = match_views(parts_[k].features, parts_[i].features, options_.features.match))
        matched.push_back({pose(k) * found->a_from_b, found->num_inliers});
    return matched;
  }

  [[nodiscard]] std::optional<AlignedView> align_from_given(std::size_t i, std::span<const MatchedPose> matched) {
    if (!has_given_poses()) return std::nullopt;
    const AlignmentStart start{pose(i - 1) * (given_[i - 1].inverse() * given_[i]), StartKind::kGiven};
    for (const MatchedPose& m : matched)
      if (m.num_matches >= options_.given.min_matches && contradicts(m.pose, start.pose, kMatchSigmas, options_))
        return std::nullopt;
    return align_from(i, std::span(&start, 1));
  }

  Result<void> follow(std::size_t i) {
    const std::vector<MatchedPose> matched = match(i);
    std::optional<AlignedView> best = align_from_given(i, matched);
    if (!best) {
      std::vector<AlignmentStart> starts;
      for (const MatchedPose& m : matched) starts.push_back({m.pose, StartKind::kMatched});
      if (i > 1) starts.push_back({pose(i - 1) * (pose(i - 2).inverse() * pose(i - 1)), StartKind::kGuess});
      starts.push_back({pose(i - 1), StartKind::kGuess});
      best = align_from(i, starts);
    }
    int num_matches = 0;
    for (const MatchedPose& m : matched) num_matches = std::max(num_matches, m.num_matches);
    if (!best) return Error{fmt::format("lost at view {}: {} matches", name(i), num_matches)};
    pose(i) = best->world_from_camera;
    num_given_ += has_given_poses() && is_near_given(i) ? 1 : 0;
    return {};
  }

  [[nodiscard]] double angle_between(std::size_t a, std::size_t b) {
    const Vector3d middle(0, 0, 0.4 * first_region_.height_m);
    const Vector3d da = (pose(a).translation - middle).normalized();
    const Vector3d db = (pose(b).translation - middle).normalized();
    return std::acos(std::clamp(da.dot(db), -1.0, 1.0));
  }

  // Whether the track has left the reach of edges from both views and come back.
  [[nodiscard]] bool is_loop(const PoseEdge& edge) {
    for (int k = edge.a + 1; k < edge.b; ++k)
      if (std::min(angle_between(edge.a, k), angle_between(k, edge.b)) > options_.max_edge_angle_rad) return true;
    return false;
  }

  void close_loops() {
    std::vector<std::pair<int, int>> pairs;
    for (std::size_t b = 1; b < parts_.size(); ++b)
      for (std::size_t a = 0; a < b; ++a)
        if (b - a == 1 || angle_between(a, b) < options_.max_edge_angle_rad)
          pairs.emplace_back(static_cast<int>(a), static_cast<int>(b));
    std::vector<Rigid3> poses;
    for (std::size_t i = 0; i < parts_.size(); ++i) poses.push_back(pose(i));
    std::vector<PoseEdge> edges = measure_edges(poses, parts_, pairs, kind_of_poses(), options_);
    std::vector<PoseEdge> loops;
    for (const PoseEdge& edge : edges)
      if (is_loop(edge)) loops.push_back(edge);
    for (const PoseEdge& loop : loops) track_.loops.emplace_back(loop.a, loop.b);
    track_.drift_m = median_error_m(track_.views, loops);
    if (kind_of_poses() == StartKind::kGiven)  // The surface of a round object does not determine its rotation.
      for (std::size_t i = 1; i < parts_.size(); ++i)
        edges.push_back({0, static_cast<int>(i), given_.front().inverse() * given_[i],
                         twist_information(options_.given.sigma_rad, options_.given.sigma_m)});
    const PoseGraph graph = adjust_pose_graph(std::move(poses), edges, options_.graph);
    for (std::size_t i = 0; i < parts_.size(); ++i) pose(i) = graph.world_from_node[i];
  }

  const TrackObjectOptions& options_;
  const TrackObjectProgress& progress_;
  std::vector<Rigid3> given_;  // Of the cameras, in the recording's frame.
  std::size_t num_given_ = 0;  // Views near them.
  ObjectTrack track_;
  ObjectRegion first_region_;
  std::vector<TrackView> parts_;
};

}  // namespace

void TrackObjectOptions::check() const {
  region.check();
  segment.check();
  features.sift.check();
  features.match.check();
  view.check();
  align.check();
  graph.check();
  check_positive("TrackObjectOptions.num_targets", num_targets);
  plausible.check();
  check_positive("TrackObjectOptions.features.sigma_m", features.sigma_m);
  check_positive("TrackObjectOptions.features.sigma_rad", features.sigma_rad);
  check_positive("TrackObjectOptions.given.sigma_m", given.sigma_m);
  check_positive("TrackObjectOptions.given.sigma_rad", given.sigma_rad);
  check_positive("TrackObjectOptions.given.min_matches", given.min_matches);
  check_in_range("TrackObjectOptions.max_edge_angle_rad", max_edge_angle_rad, 0, std::numbers::pi);
  check_in_range("TrackObjectOptions.min_still_share", min_still_share, 0, 1);
  check_not_negative("TrackObjectOptions.num_refinements", num_refinements);
  check_positive("TrackObjectOptions.join.num_views", join.num_views);
  check_in_range("TrackObjectOptions.join.min_overlap", join.min_overlap, 0, 1);
  fuse.check();
  check_in_range("TrackObjectOptions.num_threads", num_threads, 1, 4096);
}

Result<ObjectTrack> track_object(std::vector<RgbdFrame> frames, const TrackObjectOptions& options,
                                 const TrackObjectProgress& progress) {
  options.check();
  return ObjectTracker(options, progress).track(std::move(frames));
}

}  // namespace resight
