// SPDX-License-Identifier: Apache-2.0
#include "resight/modelling/coverage.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "resight/core/check.hpp"
#include "resight/geometry/fibonacci_sphere.hpp"

namespace resight {
namespace {

using Eigen::Vector3d;

constexpr int kDirections = 4000;  // About 1.8 deg apart.

std::vector<Vector3d> view_directions(std::span<const Rigid3> object_from_camera, const Vector3d& center) {
  std::vector<Vector3d> directions;
  for (const Rigid3& pose : object_from_camera) directions.push_back((pose.translation - center).normalized());
  return directions;
}

// Cosine of the angle to the nearest direction.
double nearest_cosine(const Vector3d& direction, std::span<const Vector3d> others) {
  double best = -1;
  for (const Vector3d& other : others) best = std::max(best, direction.dot(other));
  return best;
}

}  // namespace

ViewCoverage measure_coverage(std::span<const Rigid3> object_from_camera, const Vector3d& center,
                              double max_angle_rad) {
  check_in_range("max_angle_rad", max_angle_rad, 0, std::numbers::pi);
  const std::vector<Vector3d> views = view_directions(object_from_camera, center);
  ViewCoverage coverage;
  coverage.largest_gap_rad = -1;
  int above = 0;
  int below = 0;
  for (int i = 0; i < kDirections; ++i) {
    const Vector3d direction = fibonacci_direction(i, kDirections);
    const double angle_rad = std::acos(std::clamp(nearest_cosine(direction, views), -1.0, 1.0));
    if (!views.empty() && angle_rad <= max_angle_rad) ++(direction.z() > 0 ? above : below);
    if (angle_rad <= coverage.largest_gap_rad) continue;
    coverage.largest_gap_rad = angle_rad;
    coverage.largest_gap = direction;
  }
  coverage.share = static_cast<double>(above + below) / kDirections;
  coverage.share_above = 2.0 * above / kDirections;
  coverage.share_below = 2.0 * below / kDirections;
  return coverage;
}

std::vector<int> choose_key_views(std::span<const Rigid3> object_from_camera, const Vector3d& center,
                                  double min_angle_rad) {
  check_in_range("min_angle_rad", min_angle_rad, 0, std::numbers::pi);
  const std::vector<Vector3d> views = view_directions(object_from_camera, center);
  std::vector<int> chosen;
  std::vector<Vector3d> directions;
  for (std::size_t i = 0; i < views.size(); ++i) {
    if (!chosen.empty() && nearest_cosine(views[i], directions) > std::cos(min_angle_rad)) continue;
    chosen.push_back(static_cast<int>(i));
    directions.push_back(views[i]);
  }
  return chosen;
}

}  // namespace resight
