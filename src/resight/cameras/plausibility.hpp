// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace resight {

/// When the pose of a view relative to others may be right. The defaults suit views of a whole scene.
struct PlausibilityOptions {
  double min_overlap = 0.2;        ///< Least overlap with the other views.
  double max_seen_through = 0.15;  ///< Above this share of points in front of the others' surface, a pose is wrong.
  double min_correlation = 0.3;    ///< Least brightness correlation, where there is texture and no match.
  /// Throws std::invalid_argument.
  void check() const;
};

}  // namespace resight
