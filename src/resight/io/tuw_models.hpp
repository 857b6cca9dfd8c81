// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <filesystem>
#include <span>
#include <string>

#include "resight/io/model_source.hpp"

namespace resight {

/// Whether `directory` is a TUW model, which contains views/cloud_*.pcd.
[[nodiscard]] bool is_tuw_model(const std::filesystem::path& directory);

/// Reads the views (cloud_*.pcd with pose_*.txt and object_indices_*.txt or mask_*.png), 3D_model.pcd if it exists, and
/// our optional model_info.json (symmetries, obj_id).
[[nodiscard]] Result<ModelSource> read_tuw_model(const std::filesystem::path& directory, const std::string& name);

/// Writes `directory`/`name`: the views, 3D_model.pcd if `surface` is given, and model_info.json if there are
/// symmetries or an obj_id, or if it is known that there are no symmetries. Views are numbered by the digits at the end
/// of their frame names if these ascend (else 0, 1, ...). The folder appears when it is complete.
[[nodiscard]] Result<void> write_tuw_model(const std::filesystem::path& directory, const std::string& name,
                                           std::span<const TrainingView> views, const PointCloud* surface,
                                           const ObjectSymmetries& symmetries = {}, int bop_id = 0,
                                           bool symmetries_known = false);

}  // namespace resight
