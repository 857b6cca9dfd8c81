// SPDX-License-Identifier: Apache-2.0
#include "resight/geometry/outward_normals.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "resight/core/check.hpp"
#include "resight/core/parallel.hpp"
#include "resight/core/statistics.hpp"
#include "resight/geometry/fibonacci_sphere.hpp"
#include "resight/geometry/kd_tree.hpp"
#include "resight/geometry/point_cloud.hpp"
#include "resight/geometry/voxel_map.hpp"

namespace resight {
namespace {

constexpr std::size_t kPointsPerTask = 256;
constexpr double kSpacingsPerCell = 2.0;
// Only surfaces less slanted than this vote. Within a cell, their depth varies by at most the cell side times the
// tangent.
constexpr float kMinCosine = 0.6F;
constexpr double kMaxTangent = 1.3333;

// Directions spread evenly over the sphere (Fibonacci).
std::vector<Eigen::Vector3f> spread_directions(int count) {
  std::vector<Eigen::Vector3f> directions;
  for (int i = 0; i < count; ++i) directions.push_back(fibonacci_direction(i, count).cast<float>());
  return directions;
}

Eigen::Vector3f fit_normal(std::span<const Eigen::Vector3f> points, const std::vector<PointNeighbor>& neighbors) {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const PointNeighbor& n : neighbors) mean += points[static_cast<std::size_t>(n.index)].cast<double>();
  mean /= static_cast<double>(neighbors.size());
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  for (const PointNeighbor& n : neighbors) {
    const Eigen::Vector3d d = points[static_cast<std::size_t>(n.index)].cast<double>() - mean;
    covariance += d * d.transpose();
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(covariance);
  return solver.eigenvectors().col(0).cast<float>().normalized();
}

// An orthographic view of a cloud: the height of the nearest point in each cell of the image.
class HeightImage {
 public:
  HeightImage(std::span<const Eigen::Vector3f> points, const Eigen::Vector3f& to_viewer, float cell_m)
      : to_viewer_(to_viewer), right_(to_viewer.unitOrthogonal()), up_(to_viewer.cross(right_)), inverse_(1 / cell_m) {
    for (const Eigen::Vector3f& p : points) {
      const auto cell = static_cast<std::size_t>(cells_.insert(key(p)));
      if (cell == heights_.size()) heights_.push_back(p.dot(to_viewer_));
      heights_[cell] = std::max(heights_[cell], p.dot(to_viewer_));
    }
  }
  [[nodiscard]] float depth_below_surface(const Eigen::Vector3f& p) const {
    return heights_[static_cast<std::size_t>(cells_.find(key(p)))] - p.dot(to_viewer_);
  }

 private:
  [[nodiscard]] std::uint64_t key(const Eigen::Vector3f& p) const {
    return voxel_key({p.dot(right_), p.dot(up_), 0.0F}, inverse_);
  }
  Eigen::Vector3f to_viewer_;
  Eigen::Vector3f right_;
  Eigen::Vector3f up_;
  float inverse_;
  VoxelMap cells_;
  std::vector<float> heights_;
};

// For each point, the sum of n . d over the directions d from which it is visible. Positive if these lie on the side of
// its normal.
std::vector<float> vote_for_sides(std::span<const Eigen::Vector3f> points, std::span<const Eigen::Vector3f> normals,
                                  double spacing_m, const OutwardNormalsOptions& options) {
  const auto cell_m = static_cast<float>(kSpacingsPerCell * spacing_m);
  const auto max_depth_m = static_cast<float>(kMaxTangent) * cell_m;
  const std::vector<Eigen::Vector3f> directions = spread_directions(options.num_directions);
  std::vector<std::vector<float>> votes(directions.size());
  parallel_for(directions.size(), options.num_threads, [&](std::size_t d) {
    const HeightImage image(points, directions[d], cell_m);
    votes[d].assign(points.size(), 0.0F);
    for (std::size_t i = 0; i < points.size(); ++i) {
      const float cosine = normals[i].dot(directions[d]);
      if (std::abs(cosine) > kMinCosine && image.depth_below_surface(points[i]) <= max_depth_m) votes[d][i] = cosine;
    }
  });
  std::vector<float> sums(points.size(), 0.0F);
  for (const std::vector<float>& vote : votes)
    for (std::size_t i = 0; i < sums.size(); ++i) sums[i] += vote[i];
  return sums;
}

}  // namespace

void OutwardNormalsOptions::check() const {
  check_in_range("OutwardNormalsOptions.num_neighbors", num_neighbors, 3, 1000);
  check_in_range("OutwardNormalsOptions.num_directions", num_directions, 8, 10000);
  check_positive("OutwardNormalsOptions.num_threads", num_threads);
}

bool turn_outwards(std::span<const Eigen::Vector3f> points, std::span<Eigen::Vector3f> normals) {
  require(points.size() == normals.size(), "turn_outwards: points and normals differ in number");
  if (points.empty()) return false;
  double sum = 0;
  for (const Eigen::Vector3f& direction : spread_directions(64)) {
    const auto outermost = std::max_element(points.begin(), points.end(), [&](const auto& a, const auto& b) {
      return a.dot(direction) < b.dot(direction);
    });
    sum += normals[static_cast<std::size_t>(outermost - points.begin())].dot(direction);
  }
  if (sum >= 0) return false;
  for (Eigen::Vector3f& n : normals) n = -n;
  return true;
}

std::vector<Eigen::Vector3f> estimate_outward_normals(std::span<const Eigen::Vector3f> points,
                                                      const OutwardNormalsOptions& options) {
  options.check();
  const KdTree tree(points);
  std::vector<Eigen::Vector3f> normals(points.size());
  std::vector<float> spacings(points.size());
  parallel_for_blocks(points.size(), kPointsPerTask, options.num_threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      // Includes the point itself.
      const std::vector<PointNeighbor> near = tree.nearest(points[i], options.num_neighbors + 1);
      normals[i] = fit_normal(points, near);
      // A disc with k evenly spaced neighbours has the radius spacing * sqrt(k / pi).
      spacings[i] =
          std::sqrt(near.back().distance_sq * static_cast<float>(std::numbers::pi) / static_cast<float>(near.size()));
    }
  });
  const double spacing_m = upper_median(std::move(spacings));
  if (!(spacing_m > 0)) return normals;
  const std::vector<float> votes = vote_for_sides(points, normals, spacing_m, options);
  const Eigen::Vector3f center = centroid(points);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const float side = std::abs(votes[i]) > kMinCosine ? votes[i] : normals[i].dot(points[i] - center);
    if (side < 0) normals[i] = -normals[i];
  }
  return normals;
}

}  // namespace resight
