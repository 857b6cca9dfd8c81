// SPDX-License-Identifier: Apache-2.0
#include "resight/geometry/triangle_mesh.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "resight/core/check.hpp"

namespace resight {
namespace {

// Repeats the texture outside [0, 1]. A coordinate of 1, common at corners of unwrapped faces, stays at the far border.
float wrap_unit(float t) { return t >= 0 && t <= 1 ? t : t - std::floor(t); }

// False for faces that are lines or points but for the rounding of their corners.
bool has_area(const TriangleMesh& mesh, const std::array<int, 3>& f) {
  const Eigen::Vector3f a = mesh.vertices[f[1]] - mesh.vertices[f[0]];
  const Eigen::Vector3f b = mesh.vertices[f[2]] - mesh.vertices[f[0]];
  const float longest_sq = std::max({a.squaredNorm(), b.squaredNorm(), (b - a).squaredNorm()});
  return a.cross(b).norm() > 1e-6F * longest_sq;
}

}  // namespace

void TriangleMesh::append(const TriangleMesh& other) {
  if (&other == this) return append(TriangleMesh(other));  // insert() must not read from the vector that it grows
  require(texture.empty() || other.texture.empty(), "TriangleMesh::append: both meshes have a texture");
  const bool was_empty = vertices.empty();
  const auto merge = [&](auto& own, const auto& added) {
    require(was_empty || other.vertices.empty() || own.empty() == added.empty(),
            "TriangleMesh::append: the meshes have different attributes");
    own.insert(own.end(), added.begin(), added.end());
  };
  const int offset = static_cast<int>(vertices.size());
  merge(normals, other.normals);
  merge(uvs, other.uvs);
  merge(colors, other.colors);
  vertices.insert(vertices.end(), other.vertices.begin(), other.vertices.end());
  for (const auto& f : other.faces) faces.push_back({f[0] + offset, f[1] + offset, f[2] + offset});
  if (!other.texture.empty()) texture = other.texture;
}

void compute_vertex_normals(TriangleMesh& mesh) {
  mesh.normals.assign(mesh.vertices.size(), Eigen::Vector3f::Zero());
  for (const auto& f : mesh.faces) {
    const Eigen::Vector3f area_normal =
        (mesh.vertices[f[1]] - mesh.vertices[f[0]]).cross(mesh.vertices[f[2]] - mesh.vertices[f[0]]);
    for (const int v : f) mesh.normals[v] += area_normal;
  }
  for (Eigen::Vector3f& n : mesh.normals) n = n.norm() > 0 ? n.normalized() : Eigen::Vector3f::UnitZ();
}

Rgb8 surface_color(const TriangleMesh& mesh, int face, float b0, float b1) {
  const auto& f = mesh.faces[face];
  const float b2 = 1 - b0 - b1;
  const auto to_vector = [](Rgb8 c) { return Eigen::Vector3f(c.r, c.g, c.b); };
  const auto to_color = [](const Eigen::Vector3f& c) {
    const auto round = [](float x) { return static_cast<std::uint8_t>(std::clamp(x + 0.5F, 0.0F, 255.0F)); };
    return Rgb8{round(c.x()), round(c.y()), round(c.z())};
  };
  if (mesh.has_texture()) {
    const Eigen::Vector2f uv = b0 * mesh.uvs[f[0]] + b1 * mesh.uvs[f[1]] + b2 * mesh.uvs[f[2]];
    const int w = mesh.texture.width();
    const int h = mesh.texture.height();
    const float x = wrap_unit(uv.x()) * static_cast<float>(w) - 0.5F;
    const float y = wrap_unit(uv.y()) * static_cast<float>(h) - 0.5F;
    const int x0 = static_cast<int>(std::floor(x));
    const int y0 = static_cast<int>(std::floor(y));
    const float ax = x - static_cast<float>(x0);
    const float ay = y - static_cast<float>(y0);
    const auto at = [&](int u, int v) {
      return to_vector(mesh.texture(std::clamp(u, 0, w - 1), std::clamp(v, 0, h - 1)));
    };
    return to_color((1 - ay) * ((1 - ax) * at(x0, y0) + ax * at(x0 + 1, y0)) +
                    ay * ((1 - ax) * at(x0, y0 + 1) + ax * at(x0 + 1, y0 + 1)));
  }
  if (mesh.colors.size() == mesh.vertices.size()) {
    return to_color(b0 * to_vector(mesh.colors[f[0]]) + b1 * to_vector(mesh.colors[f[1]]) +
                    b2 * to_vector(mesh.colors[f[2]]));
  }
  return {128, 128, 128};
}

float diameter(std::span<const Eigen::Vector3f> points) {
  std::vector<Eigen::Vector3f> candidates(points.begin(), points.end());
  if (candidates.size() > 2000) {
    candidates.clear();
    constexpr int kDirections = 512;
    for (int i = 0; i < kDirections; ++i) {  // Fibonacci half-sphere
      const double z = (i + 0.5) / kDirections;
      const double phi = i * std::numbers::pi * (3.0 - std::sqrt(5.0));
      const double r = std::sqrt(1 - z * z);
      const Eigen::Vector3f direction(static_cast<float>(r * std::cos(phi)), static_cast<float>(r * std::sin(phi)),
                                      static_cast<float>(z));
      const auto less = [&](const auto& a, const auto& b) { return a.dot(direction) < b.dot(direction); };
      const auto [low, high] = std::minmax_element(points.begin(), points.end(), less);
      candidates.push_back(*low);
      candidates.push_back(*high);
    }
  }
  float best_sq = 0;
  for (std::size_t i = 0; i < candidates.size(); ++i)
    for (std::size_t j = i + 1; j < candidates.size(); ++j)
      best_sq = std::max(best_sq, (candidates[i] - candidates[j]).squaredNorm());
  return std::sqrt(best_sq);
}

std::vector<Eigen::Vector3f> used_vertices(const TriangleMesh& mesh) {
  std::vector<std::uint8_t> used(mesh.vertices.size(), 0);
  for (const auto& f : mesh.faces)
    if (has_area(mesh, f))  // Others are neither rendered nor sampled.
      for (const int v : f) used[v] = 1;
  std::vector<Eigen::Vector3f> vertices;
  for (std::size_t i = 0; i < used.size(); ++i)
    if (used[i] != 0) vertices.push_back(mesh.vertices[i]);
  return vertices;
}

}  // namespace resight
