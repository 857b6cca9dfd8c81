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

/// Training data of an object in metres, object frame: at least one of views, a mesh or a complete cloud.
struct ModelSource {
  std::string name;
  int bop_id = 0;                   ///< obj_id; 0 if not given.
  std::vector<TrainingView> views;  ///< TUW training views, or views of a BOP training split.
  std::optional<TriangleMesh> mesh;
  std::optional<PointCloud> surface;  ///< Complete model cloud (3D_model.pcd, or a PLY without faces).
  ObjectSymmetries symmetries;
  bool symmetries_known = false;      ///< The source declares the symmetries, possibly that there are none.
  std::vector<std::string> warnings;  ///< Missing references (such as a texture file) and ignored files, one line each.
};

/// Location of a model on disk. Listing is cheap; models are read one by one.
struct ModelLocation {
  std::string name;
  int bop_id = 0;
  std::filesystem::path path;
  std::string format;  ///< "tuw", "bop", "mesh", "cloud".
  /// Of the coordinates of a mesh or cloud. None: as the layout has it, millimetres for "bop" and metres for others.
  std::optional<double> metres_per_unit{};
};

/// Lists the models under each path, in order of name. A path is a TUW model folder (or a folder of these), a BOP
/// models folder or data set, a folder of meshes or clouds (one per file or per sub-folder), or such a file. The error
/// says what was expected.
[[nodiscard]] Result<std::vector<ModelLocation>> find_models(const std::vector<std::filesystem::path>& paths);
/// Reads one model. The error names the file. Throws std::invalid_argument for an unknown `format`.
[[nodiscard]] Result<ModelSource> read_model(const ModelLocation& location);

}  // namespace resight
