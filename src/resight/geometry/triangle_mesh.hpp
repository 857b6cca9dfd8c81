// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <array>
#include <span>
#include <vector>

#include "resight/core/image.hpp"

namespace resight {

/// A triangle mesh in metres, object frame. Faces are counter-clockwise seen from outside. `normals` (unit, per
/// vertex), `uvs` (origin top left, as in the texture image) and `colors` are empty or as long as `vertices`. The
/// texture takes precedence over vertex colours.
struct TriangleMesh {
  std::vector<Eigen::Vector3f> vertices;
  std::vector<Eigen::Vector3f> normals;
  std::vector<Eigen::Vector2f> uvs;
  std::vector<Rgb8> colors;
  std::vector<std::array<int, 3>> faces;
  Image<Rgb8> texture;

  [[nodiscard]] bool empty() const { return faces.empty(); }
  [[nodiscard]] bool has_texture() const { return !texture.empty() && uvs.size() == vertices.size(); }
  /// Appends `other`, whose attributes must match. At most one of the meshes may have a texture.
  void append(const TriangleMesh& other);
};

/// Sets the vertex normals to area-weighted means of the face normals.
void compute_vertex_normals(TriangleMesh& mesh);

/// Colour at barycentric coordinates (b0, b1, 1 - b0 - b1) of a face: from the texture (bilinear), else from vertex
/// colours, else grey.
[[nodiscard]] Rgb8 surface_color(const TriangleMesh& mesh, int face, float b0, float b1);

/// Largest distance between two points in metres (the "diameter" of BOP). Exact up to 2,000 points. For more points,
/// only the extreme points of 512 directions are compared.
[[nodiscard]] float diameter(std::span<const Eigen::Vector3f> points);
/// The vertices of faces that have an area.
[[nodiscard]] std::vector<Eigen::Vector3f> used_vertices(const TriangleMesh& mesh);

}  // namespace resight
