// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "resight/core/result.hpp"
#include "resight/geometry/triangle_mesh.hpp"

namespace resight::io {

/// One material's share of a mesh file. Without a texture, `color` is its plain colour.
struct MeshPart {
  TriangleMesh mesh;
  Rgb8 color{128, 128, 128};
  bool has_color = false;  ///< The material names a plain colour.
};

/// The parts as one mesh: one texture where all share one; several stacked into one; vertex colours where texture
/// coordinates repeat beyond [0, 1] (which a stacked texture cannot do).
[[nodiscard]] TriangleMesh join_parts(std::vector<MeshPart> parts);

/// Empties the colours if all are the same.
void drop_plain_colors(std::vector<Rgb8>& colors);

struct ImportedParts {
  std::vector<MeshPart> parts;
  std::vector<std::string> warnings;
};
/// OBJ, GLB/glTF and STL through Assimp; coordinates in the file's unit.
[[nodiscard]] Result<ImportedParts> import_mesh_parts(const std::filesystem::path& file);

}  // namespace resight::io
