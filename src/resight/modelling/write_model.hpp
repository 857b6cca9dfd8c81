// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <filesystem>

#include "resight/modelling/build_model.hpp"

namespace resight {

/// What a model folder declares of its object beyond the surface (model_info.json, docs/formats.md).
struct DeclaredModelInfo {
  ObjectSymmetries symmetries;
  int bop_id = 0;                 ///< obj_id; 0 = none.
  bool symmetries_known = false;  ///< There are no other symmetries, possibly none.
};

/// Writes a model folder (TUW format), ready for training: the key views with masks and poses in views/, the cloud as
/// 3D_model.pcd, mesh.ply (coloured, metres) and model_report.json (docs/formats.md). The last component of `directory`
/// is the model's name. The folder must be empty or not exist; it appears under its name when it is complete. `views`:
/// as passed to build_model(). model_info.json is written only if something is declared.
[[nodiscard]] Result<void> write_object_model(const std::filesystem::path& directory,
                                              std::span<const TrainingView> views, const ObjectModelBuild& build,
                                              const DeclaredModelInfo& declared = {});

}  // namespace resight
