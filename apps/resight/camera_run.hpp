// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <filesystem>
#include <optional>

#include "resight/cameras/joint_adjustment.hpp"
#include "resight/sensor/posed_sequence.hpp"

namespace resight::app {

struct TrackSequenceOptions {
  bool refine = false;                    ///< From the given poses on (InputError where there are none).
  const ModelLibrary* library = nullptr;  ///< Views that cannot be joined otherwise are joined by the objects in them.
  /// What has been tracked so far, beside the output: an interrupted run goes on from there. Removed at the end.
  std::optional<std::filesystem::path> journal;
  std::filesystem::path sequence_folder;  ///< Tells whose journal it is.
  bool adjust_objects = false;  ///< The poses of the library's objects and of the cameras are adjusted jointly.
  int num_threads = 1;
};

/// Estimates the camera poses of a sequence from its views, with progress. Warns about views that could not be joined.
/// Throws std::runtime_error if no two views could be joined.
[[nodiscard]] JointAdjustment track_sequence(const Sequence& sequence, const TrackSequenceOptions& options);

/// Views of the largest component, with their poses. `sequence` must outlive the result.
[[nodiscard]] PosedSequence take_largest_component(const Sequence& sequence, const CameraTrack& track);

}  // namespace resight::app
