// SPDX-License-Identifier: Apache-2.0
#include "resight/cameras/internal/close_loops.hpp"

#include <algorithm>
#include <compare>
#include <map>
#include <optional>
#include <set>
#include <tuple>
#include <utility>

#include "resight/cameras/internal/join_views.hpp"
#include "resight/core/parallel.hpp"

namespace resight {
namespace {

constexpr int kLoopNeighbors = 30;  // Keyframes that surfaces connect a keyframe to: time grows with the views.
constexpr double kMinLoopOverlap = 0.1;

struct KeyframePair {
  std::size_t a = 0, b = 0;
  auto operator<=>(const KeyframePair&) const = default;
};

// Each keyframe with those of the nearest viewpoints in its component.
std::vector<KeyframePair> pairs_to_align(const TrackState& state) {
  std::set<KeyframePair> pairs;
  for (std::size_t b = 0; b < state.keyframes.size(); ++b) {
    const Keyframe& second = state.keyframes[b];
    for (const std::size_t a :
         state.nearest_keyframes(state.component_of(second), state.pose_of(second), kLoopNeighbors + 1))
      if (a != b) pairs.insert({std::min(a, b), std::max(a, b)});
  }
  return {pairs.begin(), pairs.end()};
}

// Pairs that are not measured: first those that would join components, near views first, then those of near viewpoints.
std::vector<KeyframePair> pairs_to_match(const TrackState& state, const std::map<KeyframePair, PoseEdge>& measured) {
  std::vector<std::tuple<bool, double, KeyframePair>> order;
  for (std::size_t b = 0; b < state.keyframes.size(); ++b)
    for (std::size_t a = 0; a < b; ++a) {
      if (measured.contains({a, b})) continue;
      const Keyframe &first = state.keyframes[a], &second = state.keyframes[b];
      if (state.component_of(first) == state.component_of(second))
        order.emplace_back(true, state.viewpoint_distance(state.pose_of(first), state.pose_of(second)),
                           KeyframePair{a, b});
      else
        order.emplace_back(false, second.view - first.view, KeyframePair{a, b});
    }
  std::ranges::sort(order);
  order.resize(std::min(order.size(), static_cast<std::size_t>(state.options.max_feature_pairs)));
  std::vector<KeyframePair> pairs;
  for (const auto& [is_joined, distance, pair] : order) pairs.push_back(pair);
  return pairs;
}

std::optional<PoseEdge> measure_by_surfaces(const TrackState& state, const KeyframePair& pair) {
  const Keyframe &a = state.keyframes[pair.a], &b = state.keyframes[pair.b];
  const std::vector<AlignmentTarget> target{{&a.alignment, state.pose_of(a)}};
  AlignViewOptions align = state.options.align;
  align.num_threads = 1;  // Pairs are measured in parallel.
  if (evaluate_alignment(b.alignment, target, state.pose_of(b), align).overlap <= kMinLoopOverlap) return std::nullopt;
  const AlignedView aligned = align_view(b.alignment, target, state.pose_of(b), align);
  if (!is_plausible(state.options, aligned)) return std::nullopt;
  const std::vector<AlignmentTarget> back{{&b.alignment, aligned.world_from_camera}};
  if (!is_plausible(state.options, evaluate_alignment(a.alignment, back, state.pose_of(a), align))) return std::nullopt;
  return PoseEdge{a.view, b.view, state.pose_of(a).inverse() * aligned.world_from_camera,
                  edge_information(aligned.information)};
}

std::optional<PoseEdge> measure_by_features(const TrackState& state, const KeyframePair& pair) {
  const Keyframe &a = state.keyframes[pair.a], &b = state.keyframes[pair.b];
  const std::optional<KeyframeJoin> join = join_by_features(state, pair.a, b.alignment, b.features, 1);
  if (!join) return std::nullopt;
  return PoseEdge{a.view, b.view, state.pose_of(a).inverse() * join->aligned.world_from_camera,
                  edge_information(join->information)};
}

// Poses of all views. Components that edges join are put into one frame by the first edge between them.
std::vector<Rigid3> poses_in_joined_frames(const TrackState& state) {
  std::vector<Rigid3> poses;
  for (const TrackedView& view : state.views) poses.push_back(view.world_from_camera);
  std::vector<int> components;
  for (const TrackedView& view : state.views) components.push_back(view.component);
  for (const PoseEdge& e : state.edges) {
    int keep = components[static_cast<std::size_t>(e.a)], move = components[static_cast<std::size_t>(e.b)];
    if (keep == move) continue;
    Rigid3 keep_from_move =
        poses[static_cast<std::size_t>(e.a)] * e.a_from_b * poses[static_cast<std::size_t>(e.b)].inverse();
    // Given poses keep their world.
    if (state.last_given && components[static_cast<std::size_t>(*state.last_given)] == move) {
      std::swap(keep, move);
      keep_from_move = keep_from_move.inverse();
    }
    for (std::size_t v = 0; v < poses.size(); ++v) {
      if (components[v] != move) continue;
      poses[v] = keep_from_move * poses[v];
      components[v] = keep;
    }
  }
  return poses;
}

}  // namespace

void close_loops(TrackState& state, bool match) {
  std::map<KeyframePair, PoseEdge> measured;
  const auto measure = [&](const std::vector<KeyframePair>& pairs, auto method) {
    std::vector<std::optional<PoseEdge>> found(pairs.size());
    parallel_for(pairs.size(), state.options.num_threads, [&](std::size_t p) { found[p] = method(state, pairs[p]); });
    for (std::size_t p = 0; p < pairs.size(); ++p)
      if (found[p]) measured.emplace(pairs[p], *found[p]);
  };
  measure(pairs_to_align(state), measure_by_surfaces);
  if (match) measure(pairs_to_match(state, measured), measure_by_features);
  std::set<std::pair<int, int>> views_measured;
  for (const auto& [pair, edge] : measured) views_measured.emplace(edge.a, edge.b);
  std::erase_if(state.edges, [&](const PoseEdge& e) { return views_measured.contains(std::minmax(e.a, e.b)); });
  for (const auto& [pair, edge] : measured) state.edges.push_back(edge);
}

void adjust_poses(TrackState& state) {
  std::vector<Rigid3> poses = poses_in_joined_frames(state);
  for (bool again = true; again;) {
    PoseGraph graph = adjust_pose_graph(std::move(poses), state.edges, state.options.graph);
    poses = std::move(graph.world_from_node);
    std::vector<PoseEdge> kept;
    for (std::size_t e = 0; e < state.edges.size(); ++e)
      if (graph.error_sq[e] <= state.options.max_edge_error_sq) kept.push_back(state.edges[e]);
    again = kept.size() < state.edges.size();
    state.edges = std::move(kept);
  }
  const std::vector<int> components = find_connected_components(state.views.size(), state.edges);
  for (std::size_t v = 0; v < state.views.size(); ++v) {
    state.views[v].world_from_camera = poses[v];
    state.views[v].component = components[v];
  }
}

}  // namespace resight
