// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <array>
#include <filesystem>
#include <span>
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

struct JoinedMesh {
  TriangleMesh mesh;
  std::string loss;  ///< Why textures became vertex colours; empty if they did not.
};

/// Joins the parts to one mesh. A texture shared by all parts is kept; several textures are stacked into one. The uvs
/// of each face move by whole numbers into [0, 1]. A texture that repeats within a face cannot be stacked: all textures
/// become vertex colours then, and also if a part without a texture has vertex colours.
[[nodiscard]] JoinedMesh join_parts(std::vector<MeshPart> parts);

using CornerUvs = std::array<Eigen::Vector2f, 3>;

/// Gives the corners of each face these texture coordinates, 0 if they are not finite. Vertices with several ones are
/// doubled.
void set_corner_uvs(TriangleMesh& mesh, std::span<const CornerUvs> corner_uvs);

/// The parts of a mesh file, with a line for each reference that could not be read.
struct ImportedParts {
  std::vector<MeshPart> parts;
  std::vector<std::string> warnings;
};
/// Imports PLY by import_ply(), OBJ by import_obj(), and GLB/glTF and STL through Assimp. Coordinates are in the unit
/// of the file.
[[nodiscard]] Result<ImportedParts> import_mesh_parts(const std::filesystem::path& file);

}  // namespace resight::io
