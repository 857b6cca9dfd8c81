// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <filesystem>

#include "resight/modelling/build_model.hpp"

namespace resight {

/// Writes a model folder (TUW), ready for training: the key views with their masks and poses in views/, the cloud as
/// 3D_model.pcd, and beside them mesh.ply (coloured, metres) and model_report.json (docs/formats.md). The last part of
/// `directory` is the model's name. The folder must not exist or be empty; it appears when it is complete. `views`: as
/// given to build_model().
[[nodiscard]] Result<void> write_object_model(const std::filesystem::path& directory,
                                              std::span<const TrainingView> views, const ObjectModelBuild& build);

}  // namespace resight
