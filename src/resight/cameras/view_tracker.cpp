// SPDX-License-Identifier: Apache-2.0
#include "resight/cameras/view_tracker.hpp"

#include <algorithm>
#include <optional>
#include <utility>

#include "resight/cameras/internal/close_loops.hpp"
#include "resight/cameras/internal/join_views.hpp"
#include "resight/core/check.hpp"

namespace resight {
namespace {

constexpr double kMaxOpenSigma = 0.02;  // Metres and radians; less certain directions count as unconstrained.
constexpr int kNumRounds = 2;           // Rounds of loop closure; the second starts from adjusted poses.

Twist sigma_of(const TwistMatrix& information) {
  const TwistMatrix regular = information + 1e-6 * TwistMatrix::Identity();
  return regular.inverse().diagonal().cwiseMax(0).cwiseSqrt();
}

}  // namespace

struct ViewTracker::Impl : TrackState {
  explicit Impl(const TrackViewsOptions& o) : TrackState{(o.check(), o), {}, {}, {}, {}} {
    options.align.num_threads = options.num_threads;
  }

  TrackedView add_view(const PreparedView& view, const Image<std::uint8_t>* mask);
  [[nodiscard]] TrackerStep last_step() const;
  void restore_view(const TrackerStep& step, const PreparedView* view);
  void add_posed_view(const PreparedView& view);
  CameraTrack finish();

  [[nodiscard]] ViewFeatures extract(const PreparedView& view, const Image<std::uint8_t>* mask) const {
    return ViewFeatures(extract_sift(view, options.sift, mask));
  }
  // Images that are too small to be halved, or differ in size from the others, cannot be aligned.
  [[nodiscard]] bool can_align(const AlignmentView& view) const {
    return !view.levels.empty() &&
           (keyframes.empty() || view.levels.size() == keyframes.front().alignment.levels.size());
  }
  [[nodiscard]] std::vector<AlignmentTarget> targets_of(const std::vector<std::size_t>& chosen) const;
  [[nodiscard]] std::optional<KeyframeJoin> follow(const AlignmentView& view) const;
  [[nodiscard]] std::optional<KeyframeJoin> find_by_features(const AlignmentView& view,
                                                             const ViewFeatures& features) const;
  [[nodiscard]] bool is_keyframe(int component, const Rigid3& pose) const;
  void add_surface_edge(int view, const AlignmentView& alignment, const Keyframe& keyframe, const Rigid3& pose,
                        const AlignViewOptions& align);
  void add_edges(int view, const AlignmentView& alignment, const KeyframeJoin& join);
};

std::vector<AlignmentTarget> ViewTracker::Impl::targets_of(const std::vector<std::size_t>& chosen) const {
  std::vector<AlignmentTarget> targets;
  for (const std::size_t k : chosen) targets.push_back({&keyframes[k].alignment, pose_of(keyframes[k])});
  return targets;
}

// Tracks the camera from the last view, once from the same pose and once at constant velocity.
std::optional<KeyframeJoin> ViewTracker::Impl::follow(const AlignmentView& view) const {
  const TrackedView& last = views.back();
  std::vector<Rigid3> starts{last.world_from_camera};
  if (views.size() > 1 && views[views.size() - 2].component == last.component)
    starts.push_back(last.world_from_camera *
                     (views[views.size() - 2].world_from_camera.inverse() * last.world_from_camera));
  std::optional<KeyframeJoin> best;
  const std::vector<std::size_t> near = nearest_keyframes(last.component, last.world_from_camera, options.num_targets);
  if (near.empty()) return best;
  for (const Rigid3& start : starts) {
    KeyframeJoin join{static_cast<int>(near.front()), align_view(view, targets_of(near), start, options.align)};
    join.information = join.aligned.information;
    const Rigid3 step = start.inverse() * join.aligned.world_from_camera;
    const bool small = step.translation.norm() < options.follow.max_step_m &&
                       rotation_angle_rad(step.rotation, Eigen::Matrix3d::Identity()) < options.follow.max_step_rad;
    if (!small || !fits(options, join.aligned, options.follow.min_overlap) ||
        join.aligned.brightness_correlation < options.follow.min_correlation)
      continue;
    if (sigma_of(join.information).maxCoeff() > kMaxOpenSigma) continue;
    if (!best || join.score() > best->score()) best = std::move(join);
  }
  return best;
}

// Searches the most recent keyframes first, then the others.
std::optional<KeyframeJoin> ViewTracker::Impl::find_by_features(const AlignmentView& view,
                                                                const ViewFeatures& features) const {
  const std::size_t num_recent = std::min(keyframes.size(), static_cast<std::size_t>(options.num_targets));
  const auto try_all = [&](std::size_t begin, std::size_t end) {
    std::optional<KeyframeJoin> best;
    for (std::size_t k = begin; k < end; ++k) {
      std::optional<KeyframeJoin> join = join_by_features(*this, k, view, features, options.num_threads);
      if (join && (!best || join->score() > best->score())) best = std::move(join);
    }
    return best;
  };
  std::optional<KeyframeJoin> recent = try_all(keyframes.size() - num_recent, keyframes.size());
  return recent ? recent : try_all(0, keyframes.size() - num_recent);
}

// Whether a view is far from the keyframes of its component.
bool ViewTracker::Impl::is_keyframe(int component, const Rigid3& pose) const {
  const std::vector<std::size_t> nearest = nearest_keyframes(component, pose, 1);
  if (nearest.empty()) return true;
  const Rigid3& other = pose_of(keyframes[nearest.front()]);
  return (other.translation - pose.translation).norm() > options.keyframe.shift_m ||
         rotation_angle_rad(other.rotation, pose.rotation) > options.keyframe.rotation_rad;
}

// Adds an edge to a keyframe if the surfaces agree.
void ViewTracker::Impl::add_surface_edge(int view, const AlignmentView& alignment, const Keyframe& keyframe,
                                         const Rigid3& pose, const AlignViewOptions& align) {
  const std::vector<AlignmentTarget> target{{&keyframe.alignment, pose_of(keyframe)}};
  const AlignedView aligned = align_view(alignment, target, pose, align);
  if (is_plausible(options, aligned))
    edges.push_back({keyframe.view, view, pose_of(keyframe).inverse() * aligned.world_from_camera,
                     edge_information(aligned.information)});
}

// Adds edges to the keyframe of the join and to neighbouring keyframes with enough overlap.
void ViewTracker::Impl::add_edges(int view, const AlignmentView& alignment, const KeyframeJoin& join) {
  const Rigid3& pose = join.aligned.world_from_camera;
  const Keyframe& first = keyframes[static_cast<std::size_t>(join.keyframe)];
  AlignViewOptions near = options.align;
  near.num_levels = 1;
  for (const std::size_t k : nearest_keyframes(component_of(first), pose, options.num_targets))
    if (static_cast<int>(k) != join.keyframe) add_surface_edge(view, alignment, keyframes[k], pose, near);
  edges.push_back({first.view, view, pose_of(first).inverse() * pose, edge_information(join.information)});
}

TrackedView ViewTracker::Impl::add_view(const PreparedView& view, const Image<std::uint8_t>* mask) {
  AlignmentView alignment = make_alignment_view(view, options.view, mask);
  const int number = static_cast<int>(views.size());
  TrackedView tracked;
  tracked.name = view.frame.name;
  tracked.component = number;
  tracked.is_keyframe = can_align(alignment);
  if (!tracked.is_keyframe) {
    views.push_back(tracked);
    return tracked;
  }
  std::optional<ViewFeatures> features;
  std::optional<KeyframeJoin> join;
  if (!views.empty()) join = follow(alignment);
  if (!join) {
    features.emplace(extract(view, mask));
    if (!keyframes.empty()) join = find_by_features(alignment, *features);
  }
  if (join) {
    tracked.world_from_camera = join->aligned.world_from_camera;
    tracked.component = component_of(keyframes[static_cast<std::size_t>(join->keyframe)]);
    tracked.is_keyframe = is_keyframe(tracked.component, tracked.world_from_camera);
    tracked.num_matches = join->num_matches;
    tracked.overlap = join->aligned.overlap;
    tracked.sigma = sigma_of(join->information);
    add_edges(number, alignment, *join);
  }
  views.push_back(tracked);
  if (tracked.is_keyframe) {
    if (!features) features.emplace(extract(view, mask));
    keyframes.push_back({number, std::move(alignment), std::move(*features)});
  }
  return tracked;
}

TrackerStep ViewTracker::Impl::last_step() const {
  require(!views.empty(), "last_step(): no view has been added");
  const int last = static_cast<int>(views.size()) - 1;
  TrackerStep step{views.back(), {}};
  for (const PoseEdge& edge : edges)
    if (edge.b == last) step.edges.push_back(edge);
  return step;
}

void ViewTracker::Impl::restore_view(const TrackerStep& step, const PreparedView* view) {
  require(!step.view.is_keyframe || view != nullptr, "view: is required for a keyframe");
  if (step.view.is_keyframe)
    keyframes.push_back(
        {static_cast<int>(views.size()), make_alignment_view(*view, options.view), extract(*view, nullptr)});
  edges.insert(edges.end(), step.edges.begin(), step.edges.end());
  views.push_back(step.view);
}

void ViewTracker::Impl::add_posed_view(const PreparedView& view) {
  const int number = static_cast<int>(views.size());
  TrackedView tracked;
  tracked.name = view.frame.name;
  tracked.world_from_camera = view.frame.world_from_camera;
  tracked.component = last_given ? views[static_cast<std::size_t>(*last_given)].component : number;
  AlignmentView alignment = make_alignment_view(view, options.view);
  if (can_align(alignment)) {
    const Rigid3& pose = tracked.world_from_camera;
    const std::size_t num_edges = edges.size();
    if (!is_keyframe(tracked.component, pose))
      for (const std::size_t k : nearest_keyframes(tracked.component, pose, options.num_targets))
        add_surface_edge(number, alignment, keyframes[k], pose, options.align);
    tracked.is_keyframe = edges.size() == num_edges;  // Features may join a view that its neighbours do not fit.
  }
  // Other views may have been added meanwhile: their poses are not given.
  if (last_given)
    edges.push_back(
        {*last_given, number,
         views[static_cast<std::size_t>(*last_given)].world_from_camera.inverse() * tracked.world_from_camera,
         twist_information(options.given_sigma_rad, options.given_sigma_m)});
  last_given = number;
  if (tracked.is_keyframe) keyframes.push_back({number, std::move(alignment), extract(view, nullptr)});
  views.push_back(std::move(tracked));
}

CameraTrack ViewTracker::Impl::finish() {
  for (int round = 0; round < kNumRounds; ++round) {
    close_loops(*this, round == 0);
    adjust_poses(*this);
  }
  CameraTrack track;
  track.views = views;
  track.edges = edges;
  std::vector<std::optional<Rigid3>> first_from_world;
  for (TrackedView& view : track.views) {
    const auto component = static_cast<std::size_t>(view.component);
    if (first_from_world.size() <= component) first_from_world.resize(component + 1);
    if (!first_from_world[component])
      first_from_world[component] = last_given ? Rigid3::identity() : view.world_from_camera.inverse();
    view.world_from_camera = *first_from_world[component] * view.world_from_camera;
    view.world_from_camera.rotation = nearest_rotation(view.world_from_camera.rotation);
  }
  track.num_components = static_cast<int>(first_from_world.size());
  for (const PoseEdge& e : edges) {
    int between = 0;  // Number of keyframes.
    for (int v = std::min(e.a, e.b) + 1; v < std::max(e.a, e.b); ++v)
      between += views[static_cast<std::size_t>(v)].is_keyframe ? 1 : 0;
    track.num_long_edges += between >= options.num_targets ? 1 : 0;
  }
  return track;
}

void TrackViewsOptions::check() const {
  check_positive("keyframe.shift_m", keyframe.shift_m);
  check_positive("keyframe.rotation_rad", keyframe.rotation_rad);
  check_positive("num_targets", num_targets);
  check_positive("follow.max_step_m", follow.max_step_m);
  check_positive("follow.max_step_rad", follow.max_step_rad);
  plausible.check();
  check_in_range("follow.min_overlap", follow.min_overlap, 0, 1);
  check_in_range("follow.min_correlation", follow.min_correlation, -1, 1);
  check_not_negative("few_matches.max_matches", few_matches.max_matches);
  check_in_range("few_matches.min_correlation", few_matches.min_correlation, -1, 1);
  check_positive("max_edge_error_sq", max_edge_error_sq);
  check_not_negative("max_feature_pairs", max_feature_pairs);
  sift.check();
  match.check();
  view.check();
  align.check();
  graph.check();
  check_positive("given_sigma_m", given_sigma_m);
  check_positive("given_sigma_rad", given_sigma_rad);
  check_positive("num_threads", num_threads);
}

ViewTracker::ViewTracker(const TrackViewsOptions& options) : impl_(std::make_unique<Impl>(options)) {}
ViewTracker::~ViewTracker() = default;
ViewTracker::ViewTracker(ViewTracker&&) noexcept = default;
TrackedView ViewTracker::add_view(const PreparedView& view, const Image<std::uint8_t>* mask) {
  return impl_->add_view(view, mask);
}
TrackerStep ViewTracker::last_step() const { return impl_->last_step(); }
void ViewTracker::restore_view(const TrackerStep& step, const PreparedView* view) { impl_->restore_view(step, view); }
void ViewTracker::add_posed_view(const PreparedView& view) { impl_->add_posed_view(view); }
CameraTrack ViewTracker::finish() { return impl_->finish(); }

}  // namespace resight
