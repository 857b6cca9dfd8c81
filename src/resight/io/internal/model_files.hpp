// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <filesystem>
#include <map>
#include <vector>

#include "resight/io/internal/bop_dataset.hpp"
#include "resight/io/mesh.hpp"
#include "resight/io/model_source.hpp"

namespace resight::io {

/// Our own optional model_info.json beside a TUW model or a mesh in a folder of its own.
struct ModelExtras {
  int bop_id = 0;
  ObjectSymmetries symmetries;
  bool symmetries_known = false;  ///< The file has one of their keys.
};
/// Empty if there is no such file.
[[nodiscard]] Result<ModelExtras> read_model_extras(const std::filesystem::path& file);

/// Normals made unit; points whose normal is none are dropped.
[[nodiscard]] PointCloud clean_normals(PointCloud cloud);

/// The models of a BOP models folder, data set or training split: empty if `directory` is none of these.
[[nodiscard]] Result<std::vector<ModelLocation>> find_bop_models(const std::filesystem::path& directory);
[[nodiscard]] Result<ModelSource> read_bop_model(const ModelLocation& location);

/// A cloud (PCD, or PLY without faces): of one view of an object, projected into the camera that saw it, if it
/// is organised, or lies before a camera at its origin and (as far as one tells) hides nothing of itself; else of the
/// whole surface.
[[nodiscard]] Result<ModelSource> read_cloud_model(const std::filesystem::path& file, const std::string& name);

}  // namespace resight::io
