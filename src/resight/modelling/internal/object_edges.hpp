// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <span>
#include <utility>
#include <vector>

#include "resight/modelling/internal/track_view.hpp"

namespace resight {

/// A pose to align a view from. What features gave tells more of the turn of what is round than its surface does.
struct AlignmentStart {
  Rigid3 pose;
  bool is_matched = false;
};

[[nodiscard]] AlignViewOptions align_options(const TrackObjectOptions& options, bool is_matched);

[[nodiscard]] bool is_plausible(const AlignedView& aligned, const TrackObjectOptions& options);

/// Of two ways to align a view the one with the higher score is taken. Brightness tells most of the turn of what is
/// round.
[[nodiscard]] double alignment_score(const AlignedView& aligned);

/// The relative poses of pairs of views, each pair by itself: from `object_from_camera` and from their features. Pairs
/// that cannot be aligned are left out. One pose for each of `parts`.
[[nodiscard]] std::vector<PoseEdge> measure_edges(std::span<const Rigid3> object_from_camera,
                                                  std::span<const TrackView> parts,
                                                  std::span<const std::pair<int, int>> pairs,
                                                  const TrackObjectOptions& options);

/// How far apart the two views of an edge put the object's surface, metres: the median over the edges; NaN without any.
[[nodiscard]] double median_error_m(std::span<const TrainingView> views, std::span<const PoseEdge> edges);

/// The same for pairs of views, measured from their poses as they are now.
[[nodiscard]] double measure_closure(std::span<const TrainingView> views, std::span<const std::pair<int, int>> loops,
                                     const TrackObjectOptions& options);

}  // namespace resight
