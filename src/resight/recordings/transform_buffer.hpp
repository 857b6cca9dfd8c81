// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "resight/recordings/message.hpp"

namespace resight {

/// The frames of a recording: a tree, whose edges change over time or are fixed.
class TransformBuffer {
 public:
  /// Adds a transform. A fixed one holds at all times. A frame keeps its first parent; transforms to others are
  /// ignored.
  void add(const StampedTransform& transform, bool is_fixed);
  /// Sorts the transforms by time. Call it once, before find().
  void finish();

  [[nodiscard]] bool knows(const std::string& frame) const;
  /// The topmost frame above a frame; the frame itself if it has no parent.
  [[nodiscard]] std::string root_of(const std::string& frame) const;
  /// Whether a transform between the frame and its root changes over time.
  [[nodiscard]] bool is_moving(const std::string& frame) const;
  /// target_from_source at a time, interpolated between the transforms before and after it. None if the frames are not
  /// connected, or if these are more than `max_gap_s` away from each other; at the ends, the nearest one within half of
  /// that is taken.
  [[nodiscard]] std::optional<Rigid3> find(const std::string& target, const std::string& source, std::int64_t time_ns,
                                           double max_gap_s) const;
  /// All frames, in the order of their names.
  [[nodiscard]] std::vector<std::string> frames() const;
  /// The frames that move against their root, in the same order.
  [[nodiscard]] std::vector<std::string> moving_frames() const;

 private:
  struct Edge {
    std::string parent;
    bool is_fixed = false;
    bool is_moving = false;                                          ///< Some transform differs from the first one.
    std::vector<std::pair<std::int64_t, Rigid3>> parent_from_child;  ///< By time.
  };
  [[nodiscard]] std::optional<Rigid3> at(const Edge& edge, std::int64_t time_ns, double max_gap_s) const;
  /// The frames from `frame` up to its root.
  [[nodiscard]] std::vector<std::string> path_up(const std::string& frame) const;

  std::map<std::string, Edge> edges_;  ///< By the child.
};

}  // namespace resight
