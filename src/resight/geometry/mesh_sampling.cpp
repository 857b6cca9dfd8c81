// SPDX-License-Identifier: Apache-2.0
#include "resight/geometry/mesh_sampling.hpp"

#include <algorithm>
#include <cmath>

#include "resight/core/check.hpp"
#include "resight/geometry/corner_normals.hpp"

namespace resight {
namespace {

Eigen::Vector3f face_cross(const TriangleMesh& mesh, const std::array<int, 3>& f) {
  return (mesh.vertices[f[1]] - mesh.vertices[f[0]]).cross(mesh.vertices[f[2]] - mesh.vertices[f[0]]);
}

// Returns +1, or -1 for a mesh that is inside out: the sign of six times the signed volume. The volume is taken about
// the centroid, so that the direction of most faces decides for open meshes.
float find_outward_sign(const TriangleMesh& mesh) {
  const Eigen::Vector3f center = centroid(mesh.vertices);
  double volume = 0;
  for (const auto& f : mesh.faces) volume += (mesh.vertices[f[0]] - center).dot(face_cross(mesh, f));
  return volume < 0 ? -1.0F : 1.0F;
}

double total_area(const TriangleMesh& mesh) {
  double area = 0;
  for (const auto& f : mesh.faces)
    if (const float twice_area = face_cross(mesh, f).norm(); twice_area > 0) area += 0.5 * twice_area;
  return area;
}

struct Barycentric {
  float b0 = 0;
  float b1 = 0;
};

// The k-th point of the plastic-number sequence (Roberts 2018), folded from the unit square into the triangle.
Barycentric spread_point(std::size_t k) {
  const double x = std::fmod(0.5 + 0.7548776662466927 * static_cast<double>(k), 1.0);
  const double y = std::fmod(0.5 + 0.5698402909980532 * static_cast<double>(k), 1.0);
  return x + y <= 1 ? Barycentric{static_cast<float>(x), static_cast<float>(y)}
                    : Barycentric{static_cast<float>(1 - x), static_cast<float>(1 - y)};
}

using Corners = std::array<Eigen::Vector3f, 3>;

Eigen::Vector3f interpolate(const Corners& corners, Barycentric b) {
  return b.b0 * corners[0] + b.b1 * corners[1] + (1 - b.b0 - b.b1) * corners[2];
}

Eigen::Vector3f outward_normal(const Corners& normals, Barycentric b, const Eigen::Vector3f& face_normal) {
  const Eigen::Vector3f smooth = interpolate(normals, b);
  if (!(smooth.norm() > 1e-3F)) return face_normal;
  return (smooth.dot(face_normal) < 0 ? Eigen::Vector3f(-smooth) : smooth).normalized();
}

}  // namespace

PointCloud sample_surface(const TriangleMesh& mesh, double samples_per_sq_m) {
  check_positive("samples_per_sq_m", samples_per_sq_m);
  const double density = std::min(samples_per_sq_m, kMaxSurfaceSamples / total_area(mesh));
  const float sign = find_outward_sign(mesh);
  const bool has_normals = mesh.normals.size() == mesh.vertices.size();
  PointCloud cloud;
  // Carried from face to face, so that faces smaller than the share of one sample are sampled in proportion.
  double wanted = 0;
  for (std::size_t face = 0; face < mesh.faces.size(); ++face) {
    const auto& f = mesh.faces[face];
    const Eigen::Vector3f cross = face_cross(mesh, f);
    const float twice_area = cross.norm();
    if (!(twice_area > 0)) continue;
    const Eigen::Vector3f face_normal = cross * (sign / twice_area);
    const Corners corners{mesh.vertices[f[0]], mesh.vertices[f[1]], mesh.vertices[f[2]]};
    const Corners normals = has_normals ? corner_normals(mesh, static_cast<int>(face)) : Corners{};
    wanted += 0.5 * twice_area * density;
    while (static_cast<double>(cloud.size()) + 0.5 < wanted) {
      const Barycentric b = spread_point(cloud.size());
      cloud.points.push_back(interpolate(corners, b));
      cloud.normals.push_back(has_normals ? outward_normal(normals, b, face_normal) : face_normal);
      cloud.colors.push_back(surface_color(mesh, static_cast<int>(face), b.b0, b.b1));
    }
  }
  return cloud;
}

}  // namespace resight
