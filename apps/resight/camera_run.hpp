// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "resight/cameras/joint_adjustment.hpp"
#include "resight/cameras/track_journal.hpp"
#include "resight/io/sequence.hpp"
#include "resight/models/object_model.hpp"
#include "resight/sensor/posed_sequence.hpp"

namespace resight::app {

struct TrackSequenceOptions {
  bool refine = false;                    ///< From the given poses on (InputError where there are none).
  const ModelLibrary* library = nullptr;  ///< Views that cannot be joined otherwise are joined by the objects in them.
  /// What has been tracked so far: an interrupted run goes on from there. Null with `refine`. The caller removes it
  /// when the results are written.
  TrackJournal* journal = nullptr;
  bool adjust_objects = false;  ///< The poses of the library's objects and of the cameras are adjusted jointly.
  int num_threads = 1;
};

/// Opens the journal in `file`. Steps of other views than those of the sequence in `folder` are ignored. Throws an
/// InputError if the file is no journal.
[[nodiscard]] TrackJournal open_track_journal(const std::filesystem::path& file, const Sequence& sequence,
                                              const std::filesystem::path& folder);

/// Estimates the camera poses of a sequence from its views, with progress. Warns about views that could not be joined.
/// Throws an InputError, which names `folder`, if no two views could be joined; then nothing is left to go on from, nor
/// is the journal.
[[nodiscard]] JointAdjustment track_sequence(const Sequence& sequence, const std::filesystem::path& folder,
                                             const TrackSequenceOptions& options);

/// Views of the largest component, with their poses. `sequence` must outlive the result.
[[nodiscard]] PosedSequence take_largest_component(const Sequence& sequence, const CameraTrack& track);

/// Whether the value of --poses asks for poses that are estimated from the views: "auto" or "refine".
[[nodiscard]] bool is_estimated(const std::string& poses);
/// The options with the value of --poses: given, refine, auto, fixed, or a file.
[[nodiscard]] OpenSequenceOptions with_poses(OpenSequenceOptions options, const std::string& poses);
/// Opens a recorded sequence with poses, or for poses that are still to be estimated. Warns about its faults.
[[nodiscard]] std::unique_ptr<Sequence> open_recorded_input(const std::filesystem::path& where,
                                                            const OpenSequenceOptions& options,
                                                            const std::string& poses);
/// Views of the largest component with poses that were estimated as --poses asks; nullopt unless is_estimated(poses).
[[nodiscard]] std::optional<PosedSequence> estimate_poses(const Sequence& recorded, const std::filesystem::path& folder,
                                                          const std::string& poses, const ModelLibrary* library,
                                                          int num_threads);

}  // namespace resight::app
