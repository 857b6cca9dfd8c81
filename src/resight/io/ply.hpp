// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <filesystem>
#include <string>
#include <string_view>

#include "resight/core/result.hpp"
#include "resight/geometry/point_cloud.hpp"
#include "resight/geometry/triangle_mesh.hpp"

namespace resight {

/// What a PLY file holds: vertices with their attributes and, if it is a mesh, faces. The texture is not loaded.
struct PlyContent {
  TriangleMesh mesh;         ///< In the file's unit. uvs have their origin top left (the file's v axis points up).
  std::string texture_file;  ///< Of "comment TextureFile"; empty = none.
};

/// Reads ascii, binary little- and big-endian PLY. Read are x y z, nx ny nz, red green blue (or diffuse_*; integers
/// 0..255, floats 0..1), texture coordinates per vertex (texture_u/v, u/v, s/t) or per face corner (texcoord),
/// vertex_indices (or vertex_index; polygons become fans); anything else is skipped. Vertices keep their order; one is
/// split only where corner texture coordinates differ. Points that are not finite and indices out of range are errors.
[[nodiscard]] Result<PlyContent> read_ply(const std::filesystem::path& file);
/// The same from memory; `name` is for messages.
[[nodiscard]] Result<PlyContent> parse_ply(std::string_view bytes, std::string_view name);

/// The vertices of a PLY as a cloud, times `metres_per_unit`; faces are ignored.
[[nodiscard]] Result<PointCloud> read_ply_cloud(const std::filesystem::path& file, double metres_per_unit = 1.0);

/// Binary little-endian PLY with normals and colours where the cloud has them; coordinates in metres times
/// `units_per_metre`.
[[nodiscard]] Result<void> write_ply(const std::filesystem::path& file, const PointCloud& cloud,
                                     double units_per_metre = 1.0);

/// The same for a mesh, with uvs, and the texture as a PNG of the same stem beside it (named by "comment TextureFile").
/// A mesh with a texture is written without vertex colours: the texture wins.
[[nodiscard]] Result<void> write_ply(const std::filesystem::path& file, const TriangleMesh& mesh,
                                     double units_per_metre = 1.0);

}  // namespace resight
