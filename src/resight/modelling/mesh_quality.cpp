// SPDX-License-Identifier: Apache-2.0
#include "resight/modelling/mesh_quality.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <map>
#include <utility>

#include "resight/core/check.hpp"
#include "resight/core/disjoint_sets.hpp"

namespace resight {
namespace {

using Eigen::Vector3f;

constexpr double kMinHoleLength_m = 0.02;

using Edge = std::pair<int, int>;  // In the direction of its face.

// Edges without an opposite partner, sorted by start vertex.
std::vector<Edge> find_open_edges(const TriangleMesh& mesh) {
  std::vector<Edge> edges;
  for (const auto& f : mesh.faces)
    for (int k = 0; k < 3; ++k) edges.emplace_back(f[k], f[(k + 1) % 3]);
  std::ranges::sort(edges);
  std::vector<Edge> open;
  for (const Edge& e : edges)
    if (!std::ranges::binary_search(edges, Edge(e.second, e.first))) open.push_back(e);
  return open;
}

// Chains of open edges, up to where they close (or end, where more than two meet).
std::vector<std::vector<int>> find_loops(const std::vector<Edge>& open) {
  std::vector<bool> used(open.size(), false);
  std::vector<std::vector<int>> loops;
  for (std::size_t start = 0; start < open.size(); ++start) {
    if (used[start]) continue;
    std::vector<int> loop;
    std::size_t at = start;
    while (at < open.size() && !used[at]) {
      used[at] = true;
      loop.push_back(open[at].first);
      const int next = open[at].second;
      at = static_cast<std::size_t>(std::ranges::lower_bound(open, Edge(next, 0)) - open.begin());
      while (at < open.size() && open[at].first == next && used[at]) ++at;
      if (at < open.size() && open[at].first != next) break;
    }
    loops.push_back(std::move(loop));
  }
  return loops;
}

double fan_area(const TriangleMesh& mesh, const std::vector<int>& loop) {
  Vector3f middle = Vector3f::Zero();
  for (const int i : loop) middle += mesh.vertices[i] / static_cast<float>(loop.size());
  double area = 0;
  for (std::size_t k = 0; k < loop.size(); ++k) {
    const Vector3f& a = mesh.vertices[loop[k]];
    const Vector3f& b = mesh.vertices[loop[(k + 1) % loop.size()]];
    area += 0.5 * static_cast<double>((a - middle).cross(b - middle).norm());
  }
  return area;
}

template <typename T>
void keep(std::vector<T>& values, const std::vector<int>& kept) {
  if (values.empty()) return;
  std::vector<T> result;
  result.reserve(kept.size());
  for (const int i : kept) result.push_back(values[i]);
  values = std::move(result);
}

}  // namespace

double surface_area(const TriangleMesh& mesh) {
  double area = 0;
  for (const auto& f : mesh.faces)
    area +=
        0.5 * static_cast<double>(
                  (mesh.vertices[f[1]] - mesh.vertices[f[0]]).cross(mesh.vertices[f[2]] - mesh.vertices[f[0]]).norm());
  return area;
}

MeshHoles measure_holes(const TriangleMesh& mesh) {
  MeshHoles holes;
  for (const std::vector<int>& loop : find_loops(find_open_edges(mesh))) {
    double length_m = 0;
    for (std::size_t k = 0; k < loop.size(); ++k)
      length_m += static_cast<double>((mesh.vertices[loop[k]] - mesh.vertices[loop[(k + 1) % loop.size()]]).norm());
    holes.boundary_length_m += length_m;
    holes.area_sq_m += fan_area(mesh, loop);
    holes.count += length_m >= kMinHoleLength_m;
  }
  const double total = holes.area_sq_m + surface_area(mesh);
  holes.open_share = total > 0 ? holes.area_sq_m / total : 0;
  return holes;
}

TriangleMesh keep_large_parts(const TriangleMesh& mesh, double min_share) {
  check_in_range("min_share", min_share, 0, 1);
  DisjointSets parts(mesh.vertices.size());
  for (const auto& f : mesh.faces)
    for (int k = 1; k < 3; ++k) parts.join(f[0], f[k]);
  std::map<int, std::size_t> faces_of_part;
  for (const auto& f : mesh.faces) ++faces_of_part[parts.root(f[0])];
  std::size_t largest = 0;
  for (const auto& [root, count] : faces_of_part) largest = std::max(largest, count);
  std::vector<int> number(mesh.vertices.size(), -1);
  std::vector<int> kept;
  TriangleMesh result = mesh;
  result.faces.clear();
  for (std::array<int, 3> f : mesh.faces) {
    const std::size_t count = faces_of_part[parts.root(f[0])];
    if (static_cast<double>(count) < min_share * static_cast<double>(largest)) continue;
    for (int& i : f) {
      if (number[i] < 0) {
        number[i] = static_cast<int>(kept.size());
        kept.push_back(i);
      }
      i = number[i];
    }
    result.faces.push_back(f);
  }
  keep(result.vertices, kept);
  keep(result.normals, kept);
  keep(result.uvs, kept);
  keep(result.colors, kept);
  return result;
}

}  // namespace resight
