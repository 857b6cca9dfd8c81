// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <filesystem>
#include <vector>

#include "resight/io/model_source.hpp"

namespace resight::io {

/// Our optional model_info.json beside a TUW model, or beside a mesh or cloud in a folder of its own.
struct ModelExtras {
  int bop_id = 0;
  ObjectSymmetries symmetries;
  bool symmetries_known = false;  ///< The file has one of the symmetry keys.
};
/// Empty if the file does not exist.
[[nodiscard]] Result<ModelExtras> read_model_extras(const std::filesystem::path& file);

/// Normalises normals and drops points without a valid normal. If no normal is valid, removes the normals instead.
[[nodiscard]] PointCloud clean_normals(PointCloud cloud);

/// Finds the models of a BOP models folder, data set or training split. Empty if `directory` is none of these.
[[nodiscard]] Result<std::vector<ModelLocation>> find_bop_models(const std::filesystem::path& directory);
/// Reads a model that find_bop_models() has listed.
[[nodiscard]] Result<ModelSource> read_bop_model(const ModelLocation& location);

/// Reads a cloud (PCD, or PLY without faces). An organised cloud is one view of an object. An unorganised cloud is also
/// one view if it lies in front of a camera at its origin and hides no part of itself, as far as its points show; it is
/// then projected into that camera. Any other cloud is the whole surface.
[[nodiscard]] Result<ModelSource> read_cloud_model(const std::filesystem::path& file, const std::string& name,
                                                   double metres_per_unit);

}  // namespace resight::io
