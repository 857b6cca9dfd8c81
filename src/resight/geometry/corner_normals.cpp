// SPDX-License-Identifier: Apache-2.0
#include "resight/geometry/corner_normals.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace resight {
namespace {

// Vertex normals of a sphere of 80 faces differ by 21 deg from those of its faces; at the edges of a cube, by 45 deg.
constexpr float kMinSmoothDot = 0.866F;  // 30 deg
// Smaller faces hardly spread a normal, and their own one is noise in scans.
constexpr float kMinSharpSide_m = 0.005F;

}  // namespace

std::array<Eigen::Vector3f, 3> corner_normals(const TriangleMesh& mesh, int face) {
  const auto& f = mesh.faces[face];
  const std::array<Eigen::Vector3f, 3> shared{mesh.normals[f[0]], mesh.normals[f[1]], mesh.normals[f[2]]};
  const Eigen::Vector3f a = mesh.vertices[f[1]] - mesh.vertices[f[0]];
  const Eigen::Vector3f b = mesh.vertices[f[2]] - mesh.vertices[f[0]];
  if (std::max({a.squaredNorm(), b.squaredNorm(), (b - a).squaredNorm()}) < kMinSharpSide_m * kMinSharpSide_m)
    return shared;
  const Eigen::Vector3f own = a.cross(b).normalized();
  const auto is_smooth = [&](const Eigen::Vector3f& n) { return std::abs(n.dot(own)) >= kMinSmoothDot; };
  if (!own.allFinite() || own.isZero() || std::ranges::all_of(shared, is_smooth)) return shared;
  const bool is_inward = (shared[0] + shared[1] + shared[2]).dot(own) < 0;
  const Eigen::Vector3f normal = is_inward ? Eigen::Vector3f(-own) : own;
  return {normal, normal, normal};
}

}  // namespace resight
