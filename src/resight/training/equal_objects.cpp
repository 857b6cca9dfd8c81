// SPDX-License-Identifier: Apache-2.0
#include "resight/training/equal_objects.hpp"

#include <cmath>
#include <cstdlib>

#include "resight/geometry/kd_tree.hpp"

namespace resight {
namespace {

constexpr double kMinEqualShare = 0.95;
constexpr int kMaxColorDifference = 32;  // Scans of one product in two lights differ by about that.
constexpr float kMaxDistanceVoxels = 2;
constexpr float kMaxDiameterDifference = 0.02F;  // As a share; tested first, for speed.

bool is_near(const Rgb8& a, const Rgb8& b) {
  return std::abs(a.r - b.r) <= kMaxColorDifference && std::abs(a.g - b.g) <= kMaxColorDifference &&
         std::abs(a.b - b.b) <= kMaxColorDifference;
}

// Whether nearly all points of `a` are points of `b`, too.
bool is_covered(const PointCloud& a, const PointCloud& b, float max_distance_m) {
  const KdTree tree(b.points);
  std::size_t num_equal = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const PointNeighbor nearest = tree.nearest(a.points[i]);
    if (nearest.index < 0 || nearest.distance_sq > max_distance_m * max_distance_m) continue;
    if (!a.has_colors() || is_near(a.colors[i], b.colors[static_cast<std::size_t>(nearest.index)])) ++num_equal;
  }
  return static_cast<double>(num_equal) >= kMinEqualShare * static_cast<double>(a.size());
}

bool are_equal(const ObjectModel& a, const ObjectModel& b, float max_distance_m) {
  if (a.surface.empty() || b.surface.empty() || a.surface.has_colors() != b.surface.has_colors()) return false;
  if (std::abs(a.diameter_m - b.diameter_m) > kMaxDiameterDifference * a.diameter_m) return false;
  return is_covered(a.surface, b.surface, max_distance_m) && is_covered(b.surface, a.surface, max_distance_m);
}

}  // namespace

std::vector<std::pair<std::size_t, std::size_t>> find_equal_objects(const ModelLibrary& library) {
  std::vector<std::pair<std::size_t, std::size_t>> pairs;
  for (std::size_t a = 0; a < library.objects.size(); ++a)
    for (std::size_t b = a + 1; b < library.objects.size(); ++b)
      if (are_equal(library.objects[a], library.objects[b], kMaxDistanceVoxels * library.surface_voxel_m))
        pairs.emplace_back(a, b);
  return pairs;
}

}  // namespace resight
