// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include "resight/core/check.hpp"
#include "resight/io/images.hpp"
#include "resight/io/internal/files.hpp"
#include "resight/io/ply.hpp"

namespace resight {
namespace {

/// The attributes of vertex rows. Empty attributes are left out.
struct VertexArrays {
  const std::vector<Eigen::Vector3f>& points;
  const std::vector<Eigen::Vector3f>& normals;
  const std::vector<Eigen::Vector2f>& uvs;
  const std::vector<Rgb8>& colors;
};

template <typename T>
void append(std::string& bytes, const T& value) {
  bytes.append(reinterpret_cast<const char*>(&value), sizeof(T));
}

std::string make_ply_header(const VertexArrays& vertices, std::size_t num_faces, const std::string& comment) {
  std::string header = "ply\nformat binary_little_endian 1.0\ncomment written by resight\n";
  if (!comment.empty()) header += "comment " + comment + "\n";
  header += "element vertex " + std::to_string(vertices.points.size()) +
            "\nproperty float x\nproperty float y\nproperty float z\n";
  if (!vertices.normals.empty()) header += "property float nx\nproperty float ny\nproperty float nz\n";
  if (!vertices.uvs.empty()) header += "property float texture_u\nproperty float texture_v\n";
  if (!vertices.colors.empty()) header += "property uchar red\nproperty uchar green\nproperty uchar blue\n";
  if (num_faces > 0)
    header += "element face " + std::to_string(num_faces) + "\nproperty list uchar int vertex_indices\n";
  return header + "end_header\n";
}

void append_vertices(std::string& bytes, const VertexArrays& vertices, double units_per_metre) {
  for (std::size_t i = 0; i < vertices.points.size(); ++i) {
    for (int k = 0; k < 3; ++k) append(bytes, static_cast<float>(vertices.points[i][k] * units_per_metre));
    if (!vertices.normals.empty())
      for (int k = 0; k < 3; ++k) append(bytes, vertices.normals[i][k]);
    if (!vertices.uvs.empty()) {
      append(bytes, vertices.uvs[i].x());
      append(bytes, 1 - vertices.uvs[i].y());  // the v axis of PLY points up
    }
    if (!vertices.colors.empty()) append(bytes, vertices.colors[i]);
  }
}

void check_attributes(const VertexArrays& vertices, double units_per_metre) {
  const auto fits = [&](std::size_t size) { return size == 0 || size == vertices.points.size(); };
  require(fits(vertices.normals.size()) && fits(vertices.uvs.size()) && fits(vertices.colors.size()),
          "write_ply: an attribute must have one entry per point");
  require(units_per_metre > 0 && std::isfinite(units_per_metre), "write_ply: units_per_metre must be positive");
}

const std::vector<Eigen::Vector2f> kNoUvs;
const std::vector<Rgb8> kNoColors;

}  // namespace

Result<void> write_ply(const std::filesystem::path& file, const PointCloud& cloud, double units_per_metre,
                       const std::string& comment) {
  const VertexArrays vertices{cloud.points, cloud.normals, kNoUvs, cloud.colors};
  check_attributes(vertices, units_per_metre);
  std::string bytes = make_ply_header(vertices, 0, comment);
  append_vertices(bytes, vertices, units_per_metre);
  return io::write_file(file, bytes);
}

Result<void> write_ply(const std::filesystem::path& file, const TriangleMesh& mesh, double units_per_metre) {
  const bool textured = mesh.has_texture();
  const VertexArrays vertices{mesh.vertices, mesh.normals, textured ? mesh.uvs : kNoUvs,
                              textured ? kNoColors : mesh.colors};
  check_attributes(vertices, units_per_metre);
  std::string texture;
  if (textured) {
    const std::filesystem::path texture_file = std::filesystem::path(file).replace_extension(".png");
    texture = "TextureFile " + texture_file.filename().string();
    if (const auto done = write_color(texture_file, mesh.texture); !done) return done;
  }
  std::string bytes = make_ply_header(vertices, mesh.faces.size(), texture);
  append_vertices(bytes, vertices, units_per_metre);
  for (const auto& face : mesh.faces) {
    append(bytes, std::uint8_t{3});
    for (const int v : face) append(bytes, static_cast<std::int32_t>(v));
  }
  return io::write_file(file, bytes);
}

}  // namespace resight
