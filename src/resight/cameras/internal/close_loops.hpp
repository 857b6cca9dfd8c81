// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "resight/cameras/internal/track_state.hpp"

namespace resight {

/// Measures pairs of keyframes anew, from their present poses: those of near viewpoints by their surfaces and, with
/// `match`, others by features, which joins components. New edges replace those of the same views; others stay.
void close_loops(TrackState& state, bool match);

/// Adjusts all poses to the edges, and puts components that edges join into one frame. Edges that do not fit are
/// dropped, which may split components.
void adjust_poses(TrackState& state);

}  // namespace resight
