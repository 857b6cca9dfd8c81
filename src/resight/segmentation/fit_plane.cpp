// SPDX-License-Identifier: Apache-2.0
#include "resight/segmentation/internal/fit_plane.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace resight {
namespace {

constexpr float kOutlineCell_m = 0.025F;  // Wider than the spacing of points, so that outlines have no gaps.

using Points = std::span<const Eigen::Vector3f>;

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

}  // namespace

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

}  // namespace resight
