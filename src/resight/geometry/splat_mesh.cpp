// SPDX-License-Identifier: Apache-2.0
#include "resight/geometry/splat_mesh.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "resight/core/check.hpp"
#include "resight/core/parallel.hpp"
#include "resight/core/statistics.hpp"
#include "resight/geometry/kd_tree.hpp"

namespace resight {
namespace {

constexpr int kCorners = 6;
constexpr int kVertices = kCorners + 1;  // corners and centre
constexpr std::size_t kSizeNeighbor = 6;
constexpr std::size_t kSplatsPerTask = 256;
// On a square grid with side s, the sixth neighbour is sqrt(2) s away. A sigma of s / 2 keeps adjacent colours
// distinct.
constexpr float kSigmaPerRadius = 0.3536F;

using Neighbors = std::vector<std::vector<PointNeighbor>>;

float disc_radius(const std::vector<PointNeighbor>& neighbors) {
  const std::size_t k = std::min(kSizeNeighbor, neighbors.size() - 1);  // neighbour 0 is the point itself
  return std::sqrt(neighbors[k].distance_sq);
}

// Computes the corners of one disc from the surrounding points.
class DiscMaker {
 public:
  DiscMaker(const PointCloud& cloud, TriangleMesh& mesh) : cloud_(cloud), mesh_(mesh) {}

  void make(std::size_t i, const std::vector<PointNeighbor>& neighbors, float radius) const {
    const Eigen::Vector3f& normal = cloud_.normals[i];
    const Eigen::Vector3f a = normal.unitOrthogonal();
    const Eigen::Vector3f b = normal.cross(a);
    const std::size_t first = i * kVertices;
    for (int c = 0; c < kVertices; ++c) {
      const auto angle = static_cast<float>(2 * std::numbers::pi * c / kCorners);
      const float r = c == kCorners ? 0.0F : radius;
      const Eigen::Vector3f p = cloud_.points[i] + r * (std::cos(angle) * a + std::sin(angle) * b);
      mesh_.vertices[first + static_cast<std::size_t>(c)] = p;
      average(i, neighbors, p, kSigmaPerRadius * radius, first + static_cast<std::size_t>(c));
    }
    const auto v = static_cast<int>(first);
    for (int c = 0; c < kCorners; ++c)
      mesh_.faces[i * kCorners + static_cast<std::size_t>(c)] = {v + kCorners, v + c, v + (c + 1) % kCorners};
  }

 private:
  void average(std::size_t i, const std::vector<PointNeighbor>& neighbors, const Eigen::Vector3f& p, float sigma,
               std::size_t vertex) const {
    Eigen::Vector3f normal = Eigen::Vector3f::Zero();
    Eigen::Vector3f color = Eigen::Vector3f::Zero();
    float sum = 0;
    for (const PointNeighbor& n : neighbors) {
      const auto j = static_cast<std::size_t>(n.index);
      if (cloud_.normals[j].dot(cloud_.normals[i]) < 0) continue;
      const float w = std::exp(-0.5F * (cloud_.points[j] - p).squaredNorm() / (sigma * sigma)) + 1e-12F;
      normal += w * cloud_.normals[j];
      color += w * Eigen::Vector3f(cloud_.colors[j].r, cloud_.colors[j].g, cloud_.colors[j].b);
      sum += w;
    }
    const Eigen::Vector3f c = (color / sum).array() + 0.5F;
    mesh_.normals[vertex] = normal.normalized();
    mesh_.colors[vertex] = {static_cast<std::uint8_t>(c.x()), static_cast<std::uint8_t>(c.y()),
                            static_cast<std::uint8_t>(c.z())};
  }

  const PointCloud& cloud_;
  TriangleMesh& mesh_;
};

}  // namespace

void SplatMeshOptions::check() const {
  check_in_range("SplatMeshOptions.num_neighbors", num_neighbors, 6, 1000);
  check_positive("SplatMeshOptions.max_growth", max_growth);
  check_positive("SplatMeshOptions.num_threads", num_threads);
}

TriangleMesh make_splat_mesh(const PointCloud& cloud, const SplatMeshOptions& options) {
  options.check();
  require(cloud.size() >= 3 && cloud.has_normals() && cloud.has_colors(),
          "make_splat_mesh: at least three points with normals and colours are needed");
  const KdTree tree(cloud.points);
  Neighbors neighbors(cloud.size());
  std::vector<float> radii(cloud.size());
  parallel_for_blocks(cloud.size(), kSplatsPerTask, options.num_threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      neighbors[i] = tree.nearest(cloud.points[i], options.num_neighbors + 1);
      radii[i] = disc_radius(neighbors[i]);
    }
  });
  const float median_radius = upper_median(radii);
  const float max_radius = median_radius * static_cast<float>(options.max_growth);
  require(max_radius > 0, "make_splat_mesh: most points coincide");
  const float min_radius = median_radius / static_cast<float>(options.max_growth);

  TriangleMesh mesh;
  mesh.vertices.resize(cloud.size() * kVertices);
  mesh.normals.resize(mesh.vertices.size());
  mesh.colors.resize(mesh.vertices.size());
  mesh.faces.resize(cloud.size() * kCorners);
  const DiscMaker maker(cloud, mesh);
  parallel_for_blocks(cloud.size(), kSplatsPerTask, options.num_threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) maker.make(i, neighbors[i], std::clamp(radii[i], min_radius, max_radius));
  });
  return mesh;
}

}  // namespace resight
