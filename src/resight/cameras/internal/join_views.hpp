// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>

#include "resight/cameras/internal/track_state.hpp"

namespace resight {

/// A possible connection of a view to a keyframe.
struct KeyframeJoin {
  int keyframe = 0;
  AlignedView aligned;  ///< In the component of the keyframe.
  int num_matches = -1;
  TwistMatrix information = TwistMatrix::Zero();
  [[nodiscard]] double score() const { return aligned.overlap - aligned.seen_through; }
};

/// True if the view overlaps the others enough, and few of its points lie in front of their surface.
[[nodiscard]] bool fits(const TrackViewsOptions& options, const AlignedView& aligned, double min_overlap);
/// fits(), and the brightness does not disagree.
[[nodiscard]] bool is_plausible(const TrackViewsOptions& options, const AlignedView& aligned);
/// Joins a view to a keyframe by features, and aligns it. None if the views do not agree in both directions.
[[nodiscard]] std::optional<KeyframeJoin> join_by_features(const TrackState& state, std::size_t keyframe,
                                                           const AlignmentView& view, const ViewFeatures& features,
                                                           int num_threads);
/// Information of an edge: unconstrained directions stay weak, and no direction is more certain than the residual error
/// of calibration and time stamps.
[[nodiscard]] TwistMatrix edge_information(const TwistMatrix& information);

}  // namespace resight
