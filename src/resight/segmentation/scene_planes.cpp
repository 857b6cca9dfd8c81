// SPDX-License-Identifier: Apache-2.0
#include "resight/segmentation/scene_planes.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <optional>

#include "resight/core/check.hpp"
#include "resight/core/parallel.hpp"
#include "resight/segmentation/internal/fit_plane.hpp"

namespace resight {
namespace {

constexpr double kFullViewSpacing_m = 1.0 / 525.0;  // Pixel spacing of a Kinect at 1 m.
constexpr double kMinFlatShare = 0.7;  // A segment with a smaller share of points near its own plane is curved.
constexpr int kRefits = 3;             // Each takes the points near the last fit.

using Points = std::span<const Eigen::Vector3f>;

// Collects the points of planes from segments. Points of a plane are not available to later planes.
class PlaneFinder {
 public:
  PlaneFinder(Points points, Points normals, double spacing_m, const FindPlanesOptions& options)
      : points_(points),
        normals_(normals),
        max_distance_(static_cast<float>(options.max_distance_m)),
        min_dot_(static_cast<float>(std::cos(options.max_angle_rad))) {
    const double scale = std::min(1.0, std::pow(kFullViewSpacing_m / spacing_m, 2));
    min_points_ = std::max<std::size_t>(10, static_cast<std::size_t>(options.min_points * scale));
    result_.plane_of_point.assign(points.size(), -1);
    free_.resize(points.size());
    std::iota(free_.begin(), free_.end(), 0);
  }

  [[nodiscard]] std::size_t min_points() const { return min_points_; }

  void try_segment(std::vector<int> segment) {
    std::erase_if(segment, [&](int i) { return result_.plane_of_point[i] >= 0; });
    if (segment.size() < min_points_ / 2) return;
    std::optional<ScenePlane> plane = fit_segment(segment);
    if (!plane) return;
    std::vector<int> inliers = find_inliers_in_scene(*plane);
    if (inliers.size() < min_points_) return;
    *plane = fit_plane(points_, normals_, inliers);
    set_outline(*plane, points_, inliers);
    inliers = find_inliers_in_scene(*plane);
    if (inliers.size() < min_points_) return;
    plane->num_points = static_cast<int>(inliers.size());
    for (const int i : inliers) result_.plane_of_point[i] = static_cast<int>(result_.planes.size());
    result_.planes.push_back(std::move(*plane));
    std::erase_if(free_, [&](int i) { return result_.plane_of_point[i] >= 0; });
  }

  ScenePlanes take() { return std::move(result_); }

 private:
  bool is_inlier(const ScenePlane& plane, int i) const {
    return std::abs(plane.signed_distance(points_[i])) <= max_distance_ && plane.normal.dot(normals_[i]) >= min_dot_;
  }

  std::optional<ScenePlane> fit_segment(const std::vector<int>& segment) const {
    std::vector<int> inliers = segment;
    ScenePlane plane;
    for (int refit = 0; refit < kRefits; ++refit) {
      if (inliers.size() < 3) return std::nullopt;
      plane = fit_plane(points_, normals_, inliers);
      inliers.clear();
      for (const int i : segment)
        if (is_inlier(plane, i)) inliers.push_back(i);
    }
    if (static_cast<double>(inliers.size()) < kMinFlatShare * static_cast<double>(segment.size())) return std::nullopt;
    set_outline(plane, points_, inliers);
    return plane;
  }

  std::vector<int> find_inliers_in_scene(const ScenePlane& plane) const {
    std::vector<int> inliers;
    for (const int i : free_)
      if (plane.holds(points_[i], normals_[i], max_distance_, min_dot_)) inliers.push_back(i);
    return inliers;
  }

  Points points_;
  Points normals_;
  float max_distance_;
  float min_dot_;
  std::size_t min_points_ = 0;
  std::vector<int> free_;  // Points of no plane, ascending.
  ScenePlanes result_;
};

}  // namespace

void FindPlanesOptions::check() const {
  check_positive("FindPlanesOptions.max_distance_m", max_distance_m);
  check_in_range("FindPlanesOptions.max_angle_rad", max_angle_rad, 0, std::numbers::pi / 2);
  check_positive("FindPlanesOptions.min_points", min_points);
  check_positive("FindPlanesOptions.num_threads", num_threads);
}

ScenePlanes find_scene_planes(Points points, Points normals, const SmoothSegments& segments, double spacing_m,
                              const FindPlanesOptions& options) {
  PlaneFinder finder(points, normals, spacing_m, options);
  std::vector<std::vector<int>> members(static_cast<std::size_t>(segments.num_segments));
  for (std::size_t i = 0; i < points.size(); ++i)
    if (segments.segment[i] >= 0) members[segments.segment[i]].push_back(static_cast<int>(i));
  std::erase_if(members, [&](const std::vector<int>& m) { return m.size() < finder.min_points() / 2; });
  std::stable_sort(members.begin(), members.end(), [](const auto& a, const auto& b) { return a.size() > b.size(); });
  for (std::vector<int>& segment : members) finder.try_segment(std::move(segment));
  return finder.take();
}

ScenePlanes find_planes_of_downsampled(Points points, Points normals, double spacing_m,
                                       const FindPlanesOptions& options) {
  constexpr double kSmoothSpacings = 2;  // Reaches the diagonal neighbours of a voxel grid.
  const SmoothSegmentsOptions segments{.max_distance_m = kSmoothSpacings * spacing_m,
                                       .num_threads = options.num_threads};
  return find_scene_planes(points, normals, find_smooth_segments(points, normals, segments), spacing_m, options);
}

std::vector<int> assign_to_planes(Points points, Points normals, std::span<const ScenePlane> planes,
                                  const FindPlanesOptions& options) {
  const auto max_distance = static_cast<float>(options.max_distance_m);
  const auto min_dot = static_cast<float>(std::cos(options.max_angle_rad));
  std::vector<int> plane_of_point(points.size(), -1);
  parallel_for_blocks(points.size(), 4096, options.num_threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const auto holds = [&](const ScenePlane& p) { return p.holds(points[i], normals[i], max_distance, min_dot); };
      const auto found = std::find_if(planes.begin(), planes.end(), holds);
      if (found != planes.end()) plane_of_point[i] = static_cast<int>(found - planes.begin());
    }
  });
  return plane_of_point;
}

}  // namespace resight
