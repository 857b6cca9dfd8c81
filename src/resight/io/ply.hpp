// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "resight/core/result.hpp"
#include "resight/geometry/point_cloud.hpp"
#include "resight/geometry/triangle_mesh.hpp"

namespace resight {

/// Contents of a PLY file: vertices with their attributes and, if it is a mesh, faces. The textures are not loaded.
struct PlyContent {
  /// In the unit of the file. The origin of uvs is at the top left (the v axis of the file points up).
  TriangleMesh mesh;
  std::vector<std::string> texture_files;  ///< From "comment TextureFile".
  std::vector<int> face_textures;          ///< Per face, the index of its texture; -1: it has none, or no uvs.
};

/// Reads ascii, binary little-endian and binary big-endian PLY. Reads x y z, nx ny nz, red green blue (or diffuse_*;
/// integers 0..255, floats 0..1), texture coordinates per vertex (texture_u/v, u/v, s/t) or per face corner (texcoord),
/// vertex_indices (or vertex_index), polygons of at most 1024 corners that are cut into triangles, and texnumber, the
/// texture of a face. Skips everything else. Normals have length 1, or 0 if the file says none. Vertices keep their
/// order; a vertex is split only if its corner texture coordinates differ. Fails for points that are not finite and
/// indices out of range.
[[nodiscard]] Result<PlyContent> read_ply(const std::filesystem::path& file);
/// Same from memory. `name` is used in error messages.
[[nodiscard]] Result<PlyContent> parse_ply(std::string_view bytes, std::string_view name);

/// Reads the vertices of a PLY as a cloud, multiplied by `metres_per_unit`. Ignores faces.
[[nodiscard]] Result<PointCloud> read_ply_cloud(const std::filesystem::path& file, double metres_per_unit = 1.0);

/// Writes a binary little-endian PLY, with normals and colours if the cloud has them. Coordinates are metres times
/// `units_per_metre`. `comment`: a line of the header; none if it is empty.
[[nodiscard]] Result<void> write_ply(const std::filesystem::path& file, const PointCloud& cloud,
                                     double units_per_metre = 1.0, const std::string& comment = "");

/// Same for a mesh with uvs. Its texture becomes a PNG with the same stem beside it (named by "comment TextureFile"). A
/// textured mesh is written without vertex colours, because the texture takes precedence.
[[nodiscard]] Result<void> write_ply(const std::filesystem::path& file, const TriangleMesh& mesh,
                                     double units_per_metre = 1.0);

}  // namespace resight
