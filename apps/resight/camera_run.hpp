// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "resight/cameras/posed_sequence.hpp"
#include "resight/cameras/view_tracker.hpp"
#include "resight/models/object_model.hpp"

namespace resight::app {

/// Camera poses of a sequence from its views, with progress. `refine`: from the given poses on (InputError where there
/// are none). `library`: views that cannot be joined otherwise are joined by the objects in them, unless null. Views
/// that stay apart are warned of. Throws std::runtime_error when no two views could be joined.
[[nodiscard]] CameraTrack track_sequence(const Sequence& sequence, bool refine, const ModelLibrary* library,
                                         int num_threads);

/// The views of the part with the most views, with their poses. `sequence` must outlive it.
[[nodiscard]] PosedSequence take_largest_part(const Sequence& sequence, const CameraTrack& track);

}  // namespace resight::app
