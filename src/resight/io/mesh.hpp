// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Geometry>
#include <filesystem>
#include <string>
#include <vector>

#include "resight/core/result.hpp"
#include "resight/geometry/triangle_mesh.hpp"

namespace resight {

struct ReadMeshOptions {
  double metres_per_unit = 1.0;  ///< 0.001 for BOP models, which are in millimetres.
  double min_size_m = 0.005;     ///< A mesh with a smaller or larger bounding box diagonal is refused: its unit is
  double max_size_m = 5.0;       ///< most likely another one. 0 and infinity switch the checks off.
  void check() const;
};

/// A mesh with the warnings of its file.
struct MeshFile {
  TriangleMesh mesh;                  ///< In metres, with normals (computed if the file has none).
  std::vector<std::string> warnings;  ///< What is lost of the file, such as a missing texture.
};

/// Reads a triangle mesh: PLY and OBJ by our own readers, GLB/glTF and STL through Assimp. Applies scene
/// transforms, splits polygons into triangles, and drops points and lines. Several textures are stacked into one, or
/// become vertex colours if one repeats within a face or a part without a texture has vertex colours. A mesh with a
/// missing texture has no colours unless its vertices have different colours. A mesh whose faces have a larger area
/// than 100 times its squared size, or 10 times the squared largest size, is refused. Deterministic: vertices are in
/// the order of the file (PLY; by texture if it has several), of the faces (OBJ) or of Assimp's importer.
[[nodiscard]] Result<MeshFile> read_mesh(const std::filesystem::path& file, const ReadMeshOptions& options = {});

/// Whether read_mesh() reads files with this extension (ply, obj, glb, gltf, stl).
[[nodiscard]] bool is_mesh_file(const std::filesystem::path& file);

/// Fails if a corner of the box, in the frame of the object, is beyond kMaxObjectCoordinate_m.
[[nodiscard]] Result<void> check_near_origin(const Eigen::AlignedBox3f& box_m, const std::filesystem::path& file);

/// Fails if the extent of the points is not between the minimum and the maximum. The error suggests the unit of the
/// file.
[[nodiscard]] Result<void> check_size(std::span<const Eigen::Vector3f> points_m, const ReadMeshOptions& options,
                                      const std::filesystem::path& file);

}  // namespace resight
