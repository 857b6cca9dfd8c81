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
#include "resight/history/object_event.hpp"
#include "resight/io/change_files.hpp"
#include "resight/sensor/sequence.hpp"

namespace resight {

/// A true change of the scene, which happened before `view` was recorded.
struct TrueChange {
  int view = 0;
  ObjectEventKind kind = ObjectEventKind::kMoved;    ///< kAdded, kMoved or kRemoved.
  std::string object;                                ///< Name of the model.
  bool known = true;                                 ///< Whether the object is in the library.
  std::optional<Rigid3> world_from_object_before{};  ///< Absent for kAdded, and before locate_changes().
  std::optional<Rigid3> world_from_object_after{};   ///< Absent for kRemoved, and before locate_changes().
};

/// Reads the events of a sequence that has `num_views` views (read_event_file()). Those without poses need
/// locate_changes().
[[nodiscard]] Result<std::vector<TrueChange>> read_true_changes(const std::filesystem::path& file, int num_views);

/// Former places of library objects according to the true changes. Unlike find_former_places(), an object that leaves
/// the camera's view has not left its place.
[[nodiscard]] std::vector<FormerPlace> former_places_of(const std::vector<TrueChange>& changes,
                                                        const ModelLibrary& library);

/// Whether the library has the true objects of a sequence.
enum class TruthNames {
  kInLibrary,    ///< At least one by its name, or there is no true object.
  kFoundById,    ///< None by its name, but by its obj_id. The objects have the names of the library.
  kNotInLibrary  ///< None.
};

/// Ground truth of a sequence.
struct SequenceTruth {
  std::vector<TruthView> views;  ///< Empty without ground truth.
  TruthNames names = TruthNames::kInLibrary;
  /// From the events, else from the chains, else from find_former_places().
  std::vector<FormerPlace> former_places;
  /// Absent if the sequence has no file of changes; changes are then not scored.
  std::optional<std::vector<TrueChange>> changes;
  /// Surface of each changing object that is not in the library, by name. Object frame.
  std::map<std::string, PointCloud> unknown_surfaces;
};

/// Reads the ground truth of all views. If the library has none of the names, the objects get the names that it has for
/// their obj_ids. Reads the changes from the events if `files` has any, otherwise from the chains of placements
/// (infer_changes(), which reads all views). Surfaces of unknown objects are sampled from the meshes in
/// `unknown_models`, if that folder exists and there are events.
[[nodiscard]] Result<SequenceTruth> read_sequence_truth(const Sequence& sequence, const ModelLibrary& library,
                                                        const ChangeFiles& files = {},
                                                        const std::filesystem::path& unknown_models = {});

}  // namespace resight
