// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "resight/core/result.hpp"
#include "resight/evaluation/ghosts.hpp"
#include "resight/geometry/point_cloud.hpp"
#include "resight/io/sequence.hpp"
#include "resight/recognition/scene_update.hpp"

namespace resight {

/// A change of the scene as it really happened, before `view` was seen.
struct TrueChange {
  int view = 0;
  ObjectEventKind kind = ObjectEventKind::kMoved;  ///< kAdded, kMoved or kRemoved.
  std::string object;                              ///< Name of the model.
  bool known = true;                               ///< Whether the object is in the library.
  std::optional<Rigid3> world_from_object_before;  ///< Absent for kAdded.
  std::optional<Rigid3> world_from_object_after;   ///< Absent for kRemoved.
};

/// Reads the events that `resight simulate` writes (docs/formats.md). The error names the file and the rule.
[[nodiscard]] Result<std::vector<TrueChange>> read_true_changes(const std::filesystem::path& file);

/// The places that objects of the library left, by what really happened: unlike find_former_places(), an object that
/// the camera does not look at any more has not left.
[[nodiscard]] std::vector<FormerPlace> former_places_of(const std::vector<TrueChange>& changes,
                                                        const ModelLibrary& library);

/// All that is known of a sequence beforehand.
struct SequenceTruth {
  std::vector<TruthView> views;            ///< Empty without ground truth.
  std::vector<FormerPlace> former_places;  ///< Of the changes, or else of the truth: find_former_places().
  /// Absent where the sequence comes without its changes: changes are then not scored.
  std::optional<std::vector<TrueChange>> changes;
  /// Surface of each changing object that is in no library, object frame, by name.
  std::map<std::string, PointCloud> unknown_surfaces;
};

/// The ground truth of all views, and the changes if `events_file` exists. Surfaces of unknown objects are sampled from
/// the meshes in `unknown_models`, if that folder exists.
[[nodiscard]] Result<SequenceTruth> read_sequence_truth(const Sequence& sequence, const ModelLibrary& library,
                                                        const std::filesystem::path& events_file,
                                                        const std::filesystem::path& unknown_models);

}  // namespace resight
