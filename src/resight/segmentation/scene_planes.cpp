// SPDX-License-Identifier: Apache-2.0
#include "resight/segmentation/scene_planes.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <optional>

#include "resight/core/check.hpp"
#include "resight/core/parallel.hpp"

namespace resight {
namespace {

constexpr double kFullViewSpacing_m = 1.0 / 525.0;  // Pixel spacing of a Kinect at 1 m.
constexpr float kOutlineCell_m = 0.025F;            // Wider than the spacing of points, so that outlines have no gaps.
constexpr double kMinFlatShare = 0.7;  // A segment with a smaller share of points near its own plane is curved.
constexpr int kRefits = 3;             // Each takes the points near the last fit.

using Points = std::span<const Eigen::Vector3f>;

// Fits a plane to the given points by least squares. Its axes are in order of decreasing spread; its normal points to
// the side of the point normals.
ScenePlane fit_plane(Points points, Points normals, std::span<const int> indices) {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  Eigen::Vector3d mean_normal = Eigen::Vector3d::Zero();
  for (const int i : indices) {
    mean += points[i].cast<double>();
    mean_normal += normals[i].cast<double>();
  }
  mean /= static_cast<double>(indices.size());
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  for (const int i : indices) {
    const Eigen::Vector3d d = points[i].cast<double>() - mean;
    covariance += d * d.transpose();
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(covariance);
  Eigen::Vector3d normal = solver.eigenvectors().col(0);
  if (normal.dot(mean_normal) < 0) normal = -normal;
  ScenePlane plane;
  plane.normal = normal.cast<float>();
  plane.offset = static_cast<float>(normal.dot(mean));
  plane.axis_u = solver.eigenvectors().col(2).cast<float>();
  plane.axis_v = solver.eigenvectors().col(1).cast<float>();
  return plane;
}

int outline_cell(float position) { return static_cast<int>(std::floor(position / kOutlineCell_m)); }

// Adds a cell on each side, since points represent the surface around them.
void widen(std::vector<ScenePlane::Range>& ranges) {
  for (ScenePlane::Range& range : ranges) {
    if (range.last < range.first) continue;
    --range.first;
    ++range.last;
  }
}

void include(ScenePlane::Range& range, int i) {
  range = range.last < range.first ? ScenePlane::Range{i, i}
                                   : ScenePlane::Range{std::min(range.first, i), std::max(range.last, i)};
}

// Maximum over directions 11 deg apart, at most 0.5 % below the largest distance between two points.
float largest_width(const ScenePlane& plane, Points points, std::span<const int> indices) {
  constexpr int kDirections = 16;
  float largest = 0;
  for (int k = 0; k < kDirections; ++k) {
    const float angle = static_cast<float>(k) * std::numbers::pi_v<float> / kDirections;
    const Eigen::Vector3f direction = std::cos(angle) * plane.axis_u + std::sin(angle) * plane.axis_v;
    float min = std::numeric_limits<float>::infinity();
    float max = -min;
    for (const int i : indices) {
      const float position = direction.dot(points[i]);
      min = std::min(min, position);
      max = std::max(max, position);
    }
    largest = std::max(largest, max - min);
  }
  return largest;
}

void set_outline(ScenePlane& plane, Points points, std::span<const int> indices) {
  Eigen::Vector2f min = Eigen::Vector2f::Constant(std::numeric_limits<float>::infinity());
  Eigen::Vector2f max = -min;
  const auto to_uv = [&](int i) { return Eigen::Vector2f(plane.axis_u.dot(points[i]), plane.axis_v.dot(points[i])); };
  for (const int i : indices) {
    min = min.cwiseMin(to_uv(i));
    max = max.cwiseMax(to_uv(i));
  }
  plane.origin_uv = min;
  plane.extent_m = largest_width(plane, points, indices);
  plane.columns.assign(outline_cell(max.x() - min.x()) + 1, {});
  plane.rows.assign(outline_cell(max.y() - min.y()) + 1, {});
  for (const int i : indices) {
    const Eigen::Vector2f uv = to_uv(i) - min;
    const int u = outline_cell(uv.x());
    const int v = outline_cell(uv.y());
    include(plane.rows[v], u);
    include(plane.columns[u], v);
  }
  widen(plane.rows);
  widen(plane.columns);
}

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

bool ScenePlane::covers(const Eigen::Vector3f& p) const {
  const int u = outline_cell(axis_u.dot(p) - origin_uv.x());
  const int v = outline_cell(axis_v.dot(p) - origin_uv.y());
  const int num_columns = static_cast<int>(columns.size());
  const int num_rows = static_cast<int>(rows.size());
  if (u < -1 || v < -1 || u > num_columns || v > num_rows) return false;
  const Range& row = rows[std::clamp(v, 0, num_rows - 1)];
  const Range& column = columns[std::clamp(u, 0, num_columns - 1)];
  return u >= row.first && u <= row.last && v >= column.first && v <= column.last;
}

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
