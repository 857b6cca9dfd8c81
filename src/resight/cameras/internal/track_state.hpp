// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <optional>
#include <vector>

#include "resight/cameras/view_tracker.hpp"

namespace resight {

/// A view that others are aligned to.
struct Keyframe {
  int view = 0;
  AlignmentView alignment;
  ViewFeatures features;
};

/// What the tracker knows: the views so far, the keyframes among them, and the measured edges between them.
struct TrackState {
  TrackViewsOptions options;
  std::vector<Keyframe> keyframes;
  std::vector<TrackedView> views;
  std::vector<PoseEdge> edges;
  std::optional<int> last_given;  ///< The last view that came with a pose.

  [[nodiscard]] const Rigid3& pose_of(const Keyframe& k) const {
    return views[static_cast<std::size_t>(k.view)].world_from_camera;
  }
  [[nodiscard]] int component_of(const Keyframe& k) const { return views[static_cast<std::size_t>(k.view)].component; }
  /// 1 for a step that makes a keyframe.
  [[nodiscard]] double viewpoint_distance(const Rigid3& a, const Rigid3& b) const {
    return (a.translation - b.translation).norm() / options.keyframe.shift_m +
           rotation_angle_rad(a.rotation, b.rotation) / options.keyframe.rotation_rad;
  }
  /// Keyframes of the component with the most similar viewpoints, nearest first.
  [[nodiscard]] std::vector<std::size_t> nearest_keyframes(int component, const Rigid3& pose, int count) const;
};

}  // namespace resight
