// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <algorithm>
#include <cmath>
#include <vector>

#include "resight/geometry/kd_tree.hpp"
#include "resight/geometry/point_cloud.hpp"
#include "resight/geometry/triangle_mesh.hpp"
#include "resight/simulation/surface_sampling.hpp"

/// Deviation of a model from the object it was made of.
namespace resight::test {

struct SurfaceError {
  double median_m = 0;  ///< Distance of the vertices from the true surface, along its normal.
  double p95_m = 0;
  /// Share of the visible part of the true surface with a vertex within 3 mm.
  double completeness = 0;
};

inline SurfaceError measure_surface_error(const TriangleMesh& mesh, const TriangleMesh& truth) {
  if (mesh.vertices.empty()) return {1, 1, 0};
  const PointCloud surface = sample_visible_surface(truth, 0.0015);
  const KdTree tree(surface.points);
  std::vector<double> errors;
  for (const Eigen::Vector3f& p : mesh.vertices) {
    const PointNeighbor nearest = tree.nearest(p);
    const Eigen::Vector3f d = p - surface.points[nearest.index];
    const double along = std::abs(static_cast<double>(d.dot(surface.normals[nearest.index])));
    // Farther from a sample than their spacing: beyond the rim of the surface.
    errors.push_back(nearest.distance_sq > 0.002F * 0.002F ? std::sqrt(static_cast<double>(nearest.distance_sq))
                                                           : along);
  }
  std::ranges::sort(errors);
  const KdTree vertices(mesh.vertices);
  std::size_t found = 0;
  for (const Eigen::Vector3f& p : surface.points) found += vertices.nearest(p).distance_sq < 0.003F * 0.003F;
  return {errors[errors.size() / 2], errors[errors.size() * 95 / 100],
          static_cast<double>(found) / static_cast<double>(surface.size())};
}

}  // namespace resight::test
