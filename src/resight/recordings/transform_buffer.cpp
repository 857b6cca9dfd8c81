// SPDX-License-Identifier: Apache-2.0
#include "resight/recordings/transform_buffer.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <set>

namespace resight {
namespace {

/// Longer paths are taken for loops.
constexpr std::size_t kMaxDepth = 100;
/// A transform this near in time counts even where the next one is far: robots stop to look.
constexpr double kSameTime_s = 0.01;

}  // namespace

void TransformBuffer::add(const StampedTransform& transform, bool is_fixed) {
  if (transform.child.empty() || transform.child == transform.parent) return;
  const auto [it, is_new] = edges_.try_emplace(transform.child);
  Edge& edge = it->second;
  if (is_new) {
    edge.parent = transform.parent;
    edge.is_fixed = is_fixed;
  }
  if (edge.parent != transform.parent || edge.is_fixed != is_fixed) return;
  if (is_fixed && !edge.parent_from_child.empty()) return;
  // Constants are repeated, too (static_transform_publisher of ROS 1).
  if (!is_new && !is_same_pose(edge.parent_from_child.front().second, transform.parent_from_child))
    edge.is_moving = true;
  edge.parent_from_child.emplace_back(transform.stamp_ns, transform.parent_from_child);
}

void TransformBuffer::finish() {
  for (auto& [child, edge] : edges_)
    std::ranges::stable_sort(edge.parent_from_child, {}, [](const auto& stamped) { return stamped.first; });
}

bool TransformBuffer::knows(const std::string& frame) const {
  return edges_.contains(frame) ||
         std::ranges::any_of(edges_, [&](const auto& edge) { return edge.second.parent == frame; });
}

std::vector<std::string> TransformBuffer::path_up(const std::string& frame) const {
  std::vector<std::string> path{frame};
  for (auto it = edges_.find(frame); it != edges_.end() && path.size() < kMaxDepth; it = edges_.find(path.back()))
    path.push_back(it->second.parent);
  return path;
}

std::string TransformBuffer::root_of(const std::string& frame) const { return path_up(frame).back(); }

bool TransformBuffer::is_moving(const std::string& frame) const {
  return std::ranges::any_of(path_up(frame), [&](const std::string& f) {
    const auto it = edges_.find(f);
    return it != edges_.end() && it->second.is_moving;
  });
}

std::optional<Rigid3> TransformBuffer::at(const Edge& edge, std::int64_t time_ns, double max_gap_s) const {
  const auto& list = edge.parent_from_child;
  if (edge.is_fixed) return list.front().second;
  const auto after = std::ranges::lower_bound(list, time_ns, {}, [](const auto& stamped) { return stamped.first; });
  const auto seconds = [](std::int64_t from, std::int64_t to) { return static_cast<double>(to - from) * 1e-9; };
  if (after != list.end() && after != list.begin()) {
    const auto before = std::prev(after);
    const double gap_s = seconds(before->first, after->first);
    if (gap_s > max_gap_s) {
      if (seconds(time_ns, after->first) <= kSameTime_s) return after->second;
      if (seconds(before->first, time_ns) <= kSameTime_s) return before->second;
      return std::nullopt;
    }
    return interpolate(before->second, after->second, gap_s > 0 ? seconds(before->first, time_ns) / gap_s : 0);
  }
  const auto nearest = after == list.end() ? std::prev(after) : after;
  if (std::abs(seconds(nearest->first, time_ns)) > 0.5 * max_gap_s) return std::nullopt;
  return nearest->second;
}

std::optional<Rigid3> TransformBuffer::find(const std::string& target, const std::string& source, std::int64_t time_ns,
                                            double max_gap_s) const {
  const std::vector<std::string> up_from_source = path_up(source);
  const std::vector<std::string> up_from_target = path_up(target);
  const auto common = std::ranges::find_first_of(up_from_source, up_from_target);
  if (common == up_from_source.end()) return std::nullopt;
  const auto climb = [&](const std::vector<std::string>& path) -> std::optional<Rigid3> {
    Rigid3 ancestor_from_frame;
    for (const std::string& frame : path) {
      if (frame == *common) break;
      const auto step = at(edges_.at(frame), time_ns, max_gap_s);
      if (!step) return std::nullopt;
      ancestor_from_frame = *step * ancestor_from_frame;
    }
    return ancestor_from_frame;
  };
  const auto common_from_source = climb(up_from_source);
  const auto common_from_target = climb(up_from_target);
  if (!common_from_source || !common_from_target) return std::nullopt;
  return common_from_target->inverse() * *common_from_source;
}

std::vector<std::string> TransformBuffer::frames() const {
  std::set<std::string> names;
  for (const auto& [child, edge] : edges_) {
    names.insert(child);
    names.insert(edge.parent);
  }
  return {names.begin(), names.end()};
}

std::vector<std::string> TransformBuffer::moving_frames() const {
  std::vector<std::string> moving = frames();
  std::erase_if(moving, [&](const std::string& frame) { return !is_moving(frame); });
  return moving;
}

}  // namespace resight
