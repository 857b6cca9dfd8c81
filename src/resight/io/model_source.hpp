// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "resight/core/result.hpp"
#include "resight/geometry/point_cloud.hpp"
#include "resight/geometry/symmetry.hpp"
#include "resight/geometry/triangle_mesh.hpp"
#include "resight/sensor/training_view.hpp"

namespace resight {

/// What an object can be trained from: views, a mesh or a complete cloud (at least one of them), metres, object frame.
struct ModelSource {
  std::string name;
  int bop_id = 0;                   ///< obj_id; 0 = none given.
  std::vector<TrainingView> views;  ///< TUW training views (or BOP train split).
  std::optional<TriangleMesh> mesh;
  std::optional<PointCloud> surface;  ///< Complete model cloud (3D_model.pcd, a PLY without faces), if any.
  ObjectSymmetries symmetries;
  bool symmetries_known = false;      ///< Somebody has declared them, be it that there are none.
  std::vector<std::string> warnings;  ///< What the model names but lacks (a texture file), one line each.
};

/// Where a model lies on disk; cheap to list, read one by one.
struct ModelLocation {
  std::string name;
  int bop_id = 0;
  std::filesystem::path path;
  std::string format;  ///< "tuw", "bop", "mesh", "cloud".
};

/// Lists the models under each path: a TUW model folder (or a folder of those), a BOP models folder or data set, a
/// folder of meshes or clouds (each file, or each sub-folder with one), or such a file. In order
/// of name. The error says what was looked for.
[[nodiscard]] Result<std::vector<ModelLocation>> find_models(const std::vector<std::filesystem::path>& paths);
[[nodiscard]] Result<ModelSource> read_model(const ModelLocation& location);

}  // namespace resight
