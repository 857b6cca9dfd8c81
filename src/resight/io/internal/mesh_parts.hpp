// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "resight/core/result.hpp"
#include "resight/geometry/triangle_mesh.hpp"

namespace resight::io {

/// The part of a mesh file with one material. Without a texture, `color` is its uniform colour.
struct MeshPart {
  TriangleMesh mesh;
  Rgb8 color{128, 128, 128};
  bool has_color = false;  ///< The material defines a uniform colour.
};

/// Joins the parts to one mesh. A texture shared by all parts is kept; several textures are stacked into one. If
/// texture coordinates repeat beyond [0, 1], which a stacked texture cannot represent, textures become vertex colours.
[[nodiscard]] TriangleMesh join_parts(std::vector<MeshPart> parts);

/// The parts of a mesh file, with a line for each reference that could not be read.
struct ImportedParts {
  std::vector<MeshPart> parts;
  std::vector<std::string> warnings;
};
/// Imports PLY by import_ply(), OBJ by import_obj(), and GLB/glTF and STL through Assimp. Coordinates are in the unit
/// of the file.
[[nodiscard]] Result<ImportedParts> import_mesh_parts(const std::filesystem::path& file);

}  // namespace resight::io
