// SPDX-License-Identifier: Apache-2.0
#include "resight/cameras/view_tracker.hpp"

#include <algorithm>
#include <cmath>
#include <compare>
#include <map>
#include <optional>
#include <set>
#include <tuple>
#include <utility>

#include "resight/core/check.hpp"
#include "resight/core/parallel.hpp"

namespace resight {
namespace {

// Uncertainty of a pose from features alone. Its information is added to that of the surfaces, which may leave
// directions unconstrained.
constexpr double kFeatureSigma_m = 0.01;
constexpr double kFeatureSigma_rad = 0.015;
// Residual error of calibration and time stamps between any two views, independent of the number of agreeing pixels.
constexpr double kFloorSigma_m = 0.003;
constexpr double kFloorSigma_rad = 0.003;
constexpr double kMaxOpenSigma = 0.02;  // Metres and radians; less certain directions count as unconstrained.
constexpr int kNumRounds = 2;           // Rounds of loop closure; the second starts from adjusted poses.
constexpr int kLoopNeighbors = 30;      // Keyframes that surfaces connect a keyframe to: time grows with the views.
constexpr double kMinLoopOverlap = 0.1;

TwistMatrix feature_information() { return twist_information(kFeatureSigma_rad, kFeatureSigma_m); }

// Information of an edge: unconstrained directions stay weak, and no direction is more certain than the floor.
TwistMatrix edge_information(const TwistMatrix& information) {
  return limit_information(information, 1e-3, kFloorSigma_rad, kFloorSigma_m);
}

Twist sigma_of(const TwistMatrix& information) {
  const TwistMatrix regular = information + 1e-6 * TwistMatrix::Identity();
  return regular.inverse().diagonal().cwiseMax(0).cwiseSqrt();
}

struct Keyframe {
  int view = 0;
  AlignmentView alignment;
  ViewFeatures features;
};

struct KeyframePair {
  std::size_t a = 0, b = 0;
  auto operator<=>(const KeyframePair&) const = default;
};

// A possible connection of a view to a keyframe.
struct Join {
  int keyframe = 0;
  AlignedView aligned;  // In the component of the keyframe.
  int num_matches = -1;
  TwistMatrix information = TwistMatrix::Zero();
  [[nodiscard]] double score() const { return aligned.overlap - aligned.seen_through; }
};

}  // namespace

struct ViewTracker::Impl {
  explicit Impl(const TrackViewsOptions& o) : options((o.check(), o)) {
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
  [[nodiscard]] const Rigid3& pose_of(const Keyframe& k) const {
    return views[static_cast<std::size_t>(k.view)].world_from_camera;
  }
  [[nodiscard]] int component_of(const Keyframe& k) const { return views[static_cast<std::size_t>(k.view)].component; }

  // 1 for a step that makes a keyframe.
  [[nodiscard]] double viewpoint_distance(const Rigid3& a, const Rigid3& b) const {
    return (a.translation - b.translation).norm() / options.keyframe.shift_m +
           rotation_angle_rad(a.rotation, b.rotation) / options.keyframe.rotation_rad;
  }
  [[nodiscard]] std::vector<std::size_t> nearest_keyframes(int component, const Rigid3& pose, int count) const;
  [[nodiscard]] std::vector<AlignmentTarget> targets_of(const std::vector<std::size_t>& chosen) const;
  [[nodiscard]] bool fits(const AlignedView& aligned, double min_overlap) const;
  [[nodiscard]] bool agrees_with_matches(const AlignedView& aligned, int num_matches) const;
  [[nodiscard]] bool is_plausible(const AlignedView& aligned) const;
  [[nodiscard]] std::optional<Join> follow(const AlignmentView& view) const;
  [[nodiscard]] std::optional<Join> find_by_features(const AlignmentView& view, const ViewFeatures& features) const;
  [[nodiscard]] std::optional<Join> join_to(std::size_t keyframe, const AlignmentView& view,
                                            const ViewFeatures& features, int num_threads) const;
  [[nodiscard]] bool is_keyframe(const Join& join) const;
  void add_edges(int view, const AlignmentView& alignment, const Join& join);

  [[nodiscard]] std::vector<KeyframePair> pairs_to_align() const;
  [[nodiscard]] std::vector<KeyframePair> pairs_to_match(const std::map<KeyframePair, PoseEdge>& measured) const;
  [[nodiscard]] std::optional<PoseEdge> measure_by_surfaces(const KeyframePair& pair) const;
  [[nodiscard]] std::optional<PoseEdge> measure_by_features(const KeyframePair& pair) const;
  void close_loops(bool match);
  void adjust();

  TrackViewsOptions options;
  std::vector<Keyframe> keyframes;
  std::vector<TrackedView> views;
  std::vector<PoseEdge> edges;
  std::optional<int> last_given;
};

// Keyframes of the component with the most similar viewpoints, nearest first.
std::vector<std::size_t> ViewTracker::Impl::nearest_keyframes(int component, const Rigid3& pose, int count) const {
  std::vector<std::pair<double, std::size_t>> order;
  for (std::size_t k = 0; k < keyframes.size(); ++k)
    if (component_of(keyframes[k]) == component) order.emplace_back(viewpoint_distance(pose_of(keyframes[k]), pose), k);
  std::ranges::sort(order);
  order.resize(std::min(order.size(), static_cast<std::size_t>(count)));
  std::vector<std::size_t> nearest;
  for (const auto& [distance, k] : order) nearest.push_back(k);
  return nearest;
}

std::vector<AlignmentTarget> ViewTracker::Impl::targets_of(const std::vector<std::size_t>& chosen) const {
  std::vector<AlignmentTarget> targets;
  for (const std::size_t k : chosen) targets.push_back({&keyframes[k].alignment, pose_of(keyframes[k])});
  return targets;
}

bool ViewTracker::Impl::fits(const AlignedView& aligned, double min_overlap) const {
  return aligned.num_pairs > 0 && aligned.overlap >= min_overlap &&
         aligned.seen_through <= options.plausible.max_seen_through * std::min(1.0, 2 * aligned.overlap);
}

// Between views far apart, exposure and gloss change the brightness: it decides only where few matches agree.
bool ViewTracker::Impl::agrees_with_matches(const AlignedView& aligned, int num_matches) const {
  return fits(aligned, options.plausible.min_overlap) &&
         (num_matches > options.few_matches.max_matches ||
          aligned.brightness_correlation >= options.few_matches.min_correlation);
}

// Where no matches support a pose, the brightness must.
bool ViewTracker::Impl::is_plausible(const AlignedView& aligned) const {
  return fits(aligned, options.plausible.min_overlap) &&
         !(aligned.brightness_correlation < options.plausible.min_correlation);
}

// Tracks the camera from the last view, once from the same pose and once at constant velocity.
std::optional<Join> ViewTracker::Impl::follow(const AlignmentView& view) const {
  const TrackedView& last = views.back();
  std::vector<Rigid3> starts{last.world_from_camera};
  if (views.size() > 1 && views[views.size() - 2].component == last.component)
    starts.push_back(last.world_from_camera *
                     (views[views.size() - 2].world_from_camera.inverse() * last.world_from_camera));
  std::optional<Join> best;
  const std::vector<std::size_t> near = nearest_keyframes(last.component, last.world_from_camera, options.num_targets);
  if (near.empty()) return best;
  for (const Rigid3& start : starts) {
    Join join{static_cast<int>(near.front()), align_view(view, targets_of(near), start, options.align)};
    join.information = join.aligned.information;
    const Rigid3 step = start.inverse() * join.aligned.world_from_camera;
    const bool small = step.translation.norm() < options.follow.max_step_m &&
                       rotation_angle_rad(step.rotation, Eigen::Matrix3d::Identity()) < options.follow.max_step_rad;
    if (!small || !fits(join.aligned, options.follow.min_overlap) ||
        join.aligned.brightness_correlation < options.follow.min_correlation)
      continue;
    if (sigma_of(join.information).maxCoeff() > kMaxOpenSigma) continue;
    if (!best || join.score() > best->score()) best = std::move(join);
  }
  return best;
}

std::optional<Join> ViewTracker::Impl::join_to(std::size_t keyframe, const AlignmentView& view,
                                               const ViewFeatures& features, int num_threads) const {
  const Keyframe& k = keyframes[keyframe];
  const std::optional<ViewMatch> match = match_views(k.features, features, options.match);
  if (!match) return std::nullopt;
  AlignViewOptions align = options.align;
  align.num_threads = num_threads;
  align.prior_sigma_m = kFeatureSigma_m;
  align.prior_sigma_rad = kFeatureSigma_rad;
  const std::vector<AlignmentTarget> targets{{&k.alignment, pose_of(k)}};
  Join join{static_cast<int>(keyframe), align_view(view, targets, pose_of(k) * match->a_from_b, align),
            match->num_inliers};
  join.information = join.aligned.information + feature_information();
  if (!agrees_with_matches(join.aligned, match->num_inliers)) return std::nullopt;
  const std::vector<AlignmentTarget> back{{&view, join.aligned.world_from_camera}};
  if (!agrees_with_matches(evaluate_alignment(k.alignment, back, pose_of(k), align), match->num_inliers))
    return std::nullopt;
  return join;
}

// Searches the most recent keyframes first, then the others.
std::optional<Join> ViewTracker::Impl::find_by_features(const AlignmentView& view, const ViewFeatures& features) const {
  const std::size_t num_recent = std::min(keyframes.size(), static_cast<std::size_t>(options.num_targets));
  const auto try_all = [&](std::size_t begin, std::size_t end) {
    std::optional<Join> best;
    for (std::size_t k = begin; k < end; ++k) {
      std::optional<Join> join = join_to(k, view, features, options.num_threads);
      if (join && (!best || join->score() > best->score())) best = std::move(join);
    }
    return best;
  };
  std::optional<Join> recent = try_all(keyframes.size() - num_recent, keyframes.size());
  return recent ? recent : try_all(0, keyframes.size() - num_recent);
}

bool ViewTracker::Impl::is_keyframe(const Join& join) const {
  const Rigid3& pose = join.aligned.world_from_camera;
  const int component = component_of(keyframes[static_cast<std::size_t>(join.keyframe)]);
  const Rigid3& nearest = pose_of(keyframes[nearest_keyframes(component, pose, 1).front()]);
  return (nearest.translation - pose.translation).norm() > options.keyframe.shift_m ||
         rotation_angle_rad(nearest.rotation, pose.rotation) > options.keyframe.rotation_rad;
}

// Adds edges to the keyframe of the join and to neighbouring keyframes with enough overlap.
void ViewTracker::Impl::add_edges(int view, const AlignmentView& alignment, const Join& join) {
  const Rigid3& pose = join.aligned.world_from_camera;
  const Keyframe& first = keyframes[static_cast<std::size_t>(join.keyframe)];
  AlignViewOptions near = options.align;
  near.num_levels = 1;
  for (const std::size_t k : nearest_keyframes(component_of(first), pose, options.num_targets)) {
    if (static_cast<int>(k) == join.keyframe) continue;
    const std::vector<AlignmentTarget> target{{&keyframes[k].alignment, pose_of(keyframes[k])}};
    const AlignedView aligned = align_view(alignment, target, pose, near);
    if (!is_plausible(aligned)) continue;
    edges.push_back({keyframes[k].view, view, pose_of(keyframes[k]).inverse() * aligned.world_from_camera,
                     edge_information(aligned.information)});
  }
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
  std::optional<Join> join;
  if (!views.empty()) join = follow(alignment);
  if (!join) {
    features.emplace(extract(view, mask));
    if (!keyframes.empty()) join = find_by_features(alignment, *features);
  }
  if (join) {
    tracked.world_from_camera = join->aligned.world_from_camera;
    tracked.component = component_of(keyframes[static_cast<std::size_t>(join->keyframe)]);
    tracked.is_keyframe = is_keyframe(*join);
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
  tracked.is_keyframe = can_align(alignment);
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

// Each keyframe with those of the nearest viewpoints in its component.
std::vector<KeyframePair> ViewTracker::Impl::pairs_to_align() const {
  std::set<KeyframePair> pairs;
  for (std::size_t b = 0; b < keyframes.size(); ++b)
    for (const std::size_t a : nearest_keyframes(component_of(keyframes[b]), pose_of(keyframes[b]), kLoopNeighbors + 1))
      if (a != b) pairs.insert({std::min(a, b), std::max(a, b)});
  return {pairs.begin(), pairs.end()};
}

// Pairs that are not measured: first those that would join components, near views first, then those of near viewpoints.
std::vector<KeyframePair> ViewTracker::Impl::pairs_to_match(const std::map<KeyframePair, PoseEdge>& measured) const {
  std::vector<std::tuple<bool, double, KeyframePair>> order;
  for (std::size_t b = 0; b < keyframes.size(); ++b)
    for (std::size_t a = 0; a < b; ++a) {
      if (measured.contains({a, b})) continue;
      const Keyframe &first = keyframes[a], &second = keyframes[b];
      if (component_of(first) == component_of(second))
        order.emplace_back(true, viewpoint_distance(pose_of(first), pose_of(second)), KeyframePair{a, b});
      else
        order.emplace_back(false, second.view - first.view, KeyframePair{a, b});
    }
  std::ranges::sort(order);
  order.resize(std::min(order.size(), static_cast<std::size_t>(options.max_feature_pairs)));
  std::vector<KeyframePair> pairs;
  for (const auto& [is_joined, distance, pair] : order) pairs.push_back(pair);
  return pairs;
}

std::optional<PoseEdge> ViewTracker::Impl::measure_by_surfaces(const KeyframePair& pair) const {
  const Keyframe &a = keyframes[pair.a], &b = keyframes[pair.b];
  const std::vector<AlignmentTarget> target{{&a.alignment, pose_of(a)}};
  AlignViewOptions align = options.align;
  align.num_threads = 1;  // Pairs are measured in parallel.
  if (evaluate_alignment(b.alignment, target, pose_of(b), align).overlap <= kMinLoopOverlap) return std::nullopt;
  const AlignedView aligned = align_view(b.alignment, target, pose_of(b), align);
  if (!is_plausible(aligned)) return std::nullopt;
  const std::vector<AlignmentTarget> back{{&b.alignment, aligned.world_from_camera}};
  if (!is_plausible(evaluate_alignment(a.alignment, back, pose_of(a), align))) return std::nullopt;
  return PoseEdge{a.view, b.view, pose_of(a).inverse() * aligned.world_from_camera,
                  edge_information(aligned.information)};
}

std::optional<PoseEdge> ViewTracker::Impl::measure_by_features(const KeyframePair& pair) const {
  const Keyframe &a = keyframes[pair.a], &b = keyframes[pair.b];
  const std::optional<Join> join = join_to(pair.a, b.alignment, b.features, 1);
  if (!join) return std::nullopt;
  return PoseEdge{a.view, b.view, pose_of(a).inverse() * join->aligned.world_from_camera,
                  edge_information(join->information)};
}

// Measures pairs of keyframes again; their edges are replaced, others stay. `match`: also by features.
void ViewTracker::Impl::close_loops(bool match) {
  std::map<KeyframePair, PoseEdge> measured;
  const auto measure = [&](const std::vector<KeyframePair>& pairs, auto method) {
    std::vector<std::optional<PoseEdge>> found(pairs.size());
    parallel_for(pairs.size(), options.num_threads, [&](std::size_t p) { found[p] = (this->*method)(pairs[p]); });
    for (std::size_t p = 0; p < pairs.size(); ++p)
      if (found[p]) measured.emplace(pairs[p], *found[p]);
  };
  measure(pairs_to_align(), &Impl::measure_by_surfaces);
  if (match) measure(pairs_to_match(measured), &Impl::measure_by_features);
  std::set<std::pair<int, int>> views_measured;
  for (const auto& [pair, edge] : measured) views_measured.emplace(edge.a, edge.b);
  std::erase_if(edges, [&](const PoseEdge& e) { return views_measured.contains(std::minmax(e.a, e.b)); });
  for (const auto& [pair, edge] : measured) edges.push_back(edge);
}

// Adjusts all poses. Edges that do not fit are dropped, which may split components.
void ViewTracker::Impl::adjust() {
  std::vector<Rigid3> poses;
  for (const TrackedView& view : views) poses.push_back(view.world_from_camera);
  // Newly joined components start from the first edge between them.
  std::vector<int> components;
  for (const TrackedView& view : views) components.push_back(view.component);
  for (const PoseEdge& e : edges) {
    int keep = components[static_cast<std::size_t>(e.a)], move = components[static_cast<std::size_t>(e.b)];
    if (keep == move) continue;
    Rigid3 keep_from_move =
        poses[static_cast<std::size_t>(e.a)] * e.a_from_b * poses[static_cast<std::size_t>(e.b)].inverse();
    // Given poses keep their world.
    if (last_given && components[static_cast<std::size_t>(*last_given)] == move) {
      std::swap(keep, move);
      keep_from_move = keep_from_move.inverse();
    }
    for (std::size_t v = 0; v < poses.size(); ++v) {
      if (components[v] != move) continue;
      poses[v] = keep_from_move * poses[v];
      components[v] = keep;
    }
  }
  for (bool again = true; again;) {
    PoseGraph graph = adjust_pose_graph(std::move(poses), edges, options.graph);
    poses = std::move(graph.world_from_node);
    std::vector<PoseEdge> kept;
    for (std::size_t e = 0; e < edges.size(); ++e)
      if (graph.error_sq[e] <= options.max_edge_error_sq) kept.push_back(edges[e]);
    again = kept.size() < edges.size();
    edges = std::move(kept);
  }
  components = find_connected_components(views.size(), edges);
  for (std::size_t v = 0; v < views.size(); ++v) {
    views[v].world_from_camera = poses[v];
    views[v].component = components[v];
  }
}

CameraTrack ViewTracker::Impl::finish() {
  for (int round = 0; round < kNumRounds; ++round) {
    close_loops(round == 0);
    adjust();
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
    track.num_loops += between >= options.num_targets ? 1 : 0;
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
