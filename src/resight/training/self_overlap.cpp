// SPDX-License-Identifier: Apache-2.0
#include "resight/training/internal/self_overlap.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "resight/core/parallel.hpp"
#include "resight/core/statistics.hpp"
#include "resight/geometry/triangle_mesh.hpp"
#include "resight/registration/point_to_plane.hpp"

namespace resight::internal {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;

constexpr std::size_t kMaxPoints = 20000;  // more points only take longer
constexpr std::size_t kPointsPerTask = 256;
constexpr int kAreaNeighbors = 12;
constexpr int kMatchNeighbors = 12;  // all within about two spacings
constexpr int kRoughNeighbors = 4;
constexpr double kReachSpacings = 1.2;
constexpr int kRoughSamples = 50;
constexpr int kIcpSamples = 120;
constexpr int kIcpNeighbors = 4;
constexpr int kIcpSteps = 10;
constexpr float kIcpMinCosine = 0.7F;
// Initial share of the radius: the displacement of a half turn if its axis is off by 4 deg.
constexpr double kIcpReach = 0.15;
constexpr double kIcpDecay = 0.7;  // per step
// Relative to the mean square of the derivatives of residuals. Damps directions that the shape does not determine.
constexpr double kIcpDamping = 1e-4;

PointCloud downsample(const PointCloud& surface) {
  if (surface.size() <= kMaxPoints) return surface;
  std::vector<int> kept;
  for (std::size_t i = 0; i < kMaxPoints; ++i) kept.push_back(static_cast<int>(i * surface.size() / kMaxPoints));
  return select(surface, kept);
}

// Area that each point represents, up to a factor. Points of a voxel grid are denser where the surface is oblique.
std::vector<double> find_areas(const PointCloud& surface, const KdTree& tree, int num_threads) {
  std::vector<double> areas(surface.size());
  parallel_for_blocks(surface.size(), kPointsPerTask, num_threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      areas[i] =
          std::numbers::pi * tree.nearest(surface.points[i], kAreaNeighbors + 1).back().distance_sq / kAreaNeighbors;
  });
  return areas;
}

// Selects `count` points that represent equal areas (low-variance resampling).
std::vector<int> spread_samples(const std::vector<double>& areas, int count) {
  double total = 0;
  for (const double area : areas) total += area;
  std::vector<int> samples;
  double sum = 0;
  for (std::size_t i = 0; i < areas.size(); ++i) {
    sum += areas[i];
    while (static_cast<double>(samples.size()) + 0.5 < sum / total * count) samples.push_back(static_cast<int>(i));
  }
  return samples;
}

// Converts by ITU-R BT.601.
Vector3f to_ycbcr(const Vector3f& rgb) {
  const float y = 0.299F * rgb.x() + 0.587F * rgb.y() + 0.114F * rgb.z();
  return {y, 0.564F * (rgb.z() - y), 0.713F * (rgb.x() - y)};
}

// Mean colour around each point, over points with similar normals.
std::vector<Vector3f> blur_colors(const PointCloud& surface, const KdTree& tree, double radius_m, int num_threads) {
  std::vector<Vector3f> blurred(surface.colors.size());
  parallel_for_blocks(blurred.size(), kPointsPerTask, num_threads, [&](std::size_t begin, std::size_t end) {
    std::vector<PointNeighbor> neighbors;
    for (std::size_t i = begin; i < end; ++i) {
      tree.within(surface.points[i], radius_m, neighbors);
      neighbors.push_back({.index = static_cast<int>(i), .distance_sq = 0});  // never empty
      Vector3f sum = Vector3f::Zero();
      float count = 0;
      for (const PointNeighbor& neighbor : neighbors) {
        const auto j = static_cast<std::size_t>(neighbor.index);
        if (surface.normals[j].dot(surface.normals[i]) < 0.5F) continue;
        const Rgb8 c = surface.colors[j];
        sum += Vector3f(c.r, c.g, c.b) / 255.0F;
        count += 1;
      }
      blurred[i] = to_ycbcr(sum / std::max(count, 1.0F));
    }
  });
  return blurred;
}

// Adds a residual n . (motion p - s) and with its derivative by a twist of the axis about `center`, in units of `scale`
// metres: motion' = T motion T^-1.
void add_pair(const Rigid3& motion, const Vector3d& p, const Vector3d& s, const Vector3d& n, const Vector3d& center,
              double scale, NormalEquations& equations) {
  const Vector3d q = motion * p;
  const Vector3d n_before = motion.rotation.transpose() * n;
  Vector6 row;
  row << ((q - center).cross(n) - (p - center).cross(n_before)) / scale, n - n_before;
  equations.add_row(row, -n.dot(q - s) / scale);
}

Vector6 solve_damped(const NormalEquations& equations) {
  const double damping = kIcpDamping * equations.matrix.trace() + 1e-12;
  return (equations.matrix + damping * Matrix6::Identity()).ldlt().solve(equations.right);
}

RotationAxis move_axis(const RotationAxis& axis, const Vector6& twist, const Vector3d& center, double scale) {
  const double angle = twist.head<3>().norm();
  const Eigen::Matrix3d turn = angle > 0 ? Rigid3::from_axis_angle(twist.head<3>(), angle).rotation
                                         : Eigen::Matrix3d(Eigen::Matrix3d::Identity());
  return {(turn * axis.direction).normalized(), center + turn * (axis.point - center) + twist.tail<3>() * scale};
}

}  // namespace

SelfOverlap::SelfOverlap(const PointCloud& surface, const SymmetryOptions& options)
    : surface_(downsample(surface)), options_(options), tree_(surface_.points) {
  const std::vector<double> areas = find_areas(surface_, tree_, options.num_threads);
  samples_ = spread_samples(areas, options.num_samples);
  double total = 0;
  Vector3d normals = Vector3d::Zero();
  for (std::size_t i = 0; i < areas.size(); ++i) {
    normals += areas[i] * surface_.normals[i].cast<double>();
    center_ += areas[i] * surface_.points[i].cast<double>();
    total += areas[i];
  }
  center_ /= total;
  mean_normal_length_ = normals.norm() / total;
  for (std::size_t i = 0; i < areas.size(); ++i) {
    const Vector3d d = surface_.points[i].cast<double>() - center_;
    covariance_ += areas[i] / total * d * d.transpose();
    radius_m_ = std::max(radius_m_, d.norm());
  }
  limits_.num_neighbors = kMatchNeighbors;
  min_cosine_ = static_cast<float>(std::cos(options.max_normal_angle_rad));
  const double diameter_m = diameter(surface_.points);
  const double spacing_m = std::sqrt(upper_median(areas));
  limits_.distance_m = static_cast<float>(std::max(options.max_distance_m, options.max_distance_share * diameter_m));
  limits_.reach_m = limits_.distance_m + static_cast<float>(kReachSpacings * spacing_m);
  if (surface_.has_colors())
    colors_ =
        blur_colors(surface_, tree_, std::max(2 * spacing_m, options.blur_share * diameter_m), options.num_threads);
}

SelfOverlap::Match SelfOverlap::match(const Rigid3f& motion, int sample, const Limits& limits) const {
  const auto i = static_cast<std::size_t>(sample);
  const Vector3f p = motion * surface_.points[i];
  const Vector3f n = motion.rotation * surface_.normals[i];
  Match best = Match::kNone;
  for (const PointNeighbor& neighbor : tree_.nearest(p, limits.num_neighbors)) {
    if (neighbor.distance_sq > limits.reach_m * limits.reach_m || best == Match::kClose) break;
    const auto j = static_cast<std::size_t>(neighbor.index);
    if (surface_.normals[j].dot(n) < min_cosine_) continue;
    if (std::abs(surface_.normals[j].dot(p - surface_.points[j])) > limits.distance_m) continue;
    best = std::max(best, colors_.empty() ? Match::kClose : compare_colors(i, j));
  }
  return best;
}

SelfOverlap::Match SelfOverlap::compare_colors(std::size_t i, std::size_t j) const {
  const Vector3f difference = colors_[i] - colors_[j];
  const double share = std::max(std::abs(difference.x()) / options_.max_brightness_difference,
                                difference.tail<2>().norm() / options_.max_chroma_difference);
  if (share > 1) return Match::kNone;
  return share > 0.5 ? Match::kLike : Match::kClose;
}

double SelfOverlap::share_of(const Rigid3& motion, int stride, const Limits& limits, double min_like,
                             double min_close) const {
  const Rigid3f moved(motion);
  const auto step = static_cast<std::size_t>(stride);
  const std::size_t num_compared = (samples_.size() + step - 1) / step;
  const auto count = static_cast<double>(num_compared);
  int unlike = 0;
  int not_close = 0;
  for (std::size_t k = 0; k < samples_.size(); k += step) {
    const Match found = match(moved, samples_[k], limits);
    unlike += found == Match::kNone ? 1 : 0;
    not_close += found != Match::kClose ? 1 : 0;
    if (unlike > (1 - min_like) * count || not_close > (1 - min_close) * count) return 0;
  }
  return 1 - unlike / count;
}

bool SelfOverlap::is_symmetry(const Rigid3& motion) const {
  return share_of(motion, 1, limits_, options_.min_agreement, options_.min_close_agreement) > 0;
}

double SelfOverlap::share(const Rigid3& motion) const { return share_of(motion, 1, limits_, 0, 0); }

double SelfOverlap::rough_share(const Rigid3& motion, double slack_rad, double min_share) const {
  const auto slack_m = static_cast<float>(slack_rad * radius_m_);
  const int stride = std::max(1, static_cast<int>(samples_.size()) / kRoughSamples);
  const Limits limits{limits_.distance_m + slack_m, limits_.reach_m + slack_m, kRoughNeighbors};
  return share_of(motion, stride, limits, min_share, 0);
}

int SelfOverlap::find_partner(const Vector3f& point, const Vector3f& normal, double reach_m) const {
  for (const PointNeighbor& neighbor : tree_.nearest(point, kIcpNeighbors)) {
    if (neighbor.distance_sq > reach_m * reach_m) break;
    if (surface_.normals[static_cast<std::size_t>(neighbor.index)].dot(normal) > kIcpMinCosine) return neighbor.index;
  }
  return -1;
}

RotationAxis SelfOverlap::refine(RotationAxis axis, std::span<const double> angles_rad) const {
  const std::size_t stride = std::max<std::size_t>(1, samples_.size() / kIcpSamples);
  double reach_m = kIcpReach * radius_m_;
  for (int step = 0; step < kIcpSteps; ++step, reach_m *= kIcpDecay) {
    NormalEquations equations;
    for (const double angle : angles_rad) {
      const Rigid3 motion = rotation_about(axis, angle);
      const Rigid3f moved(motion);
      for (std::size_t k = 0; k < samples_.size(); k += stride) {
        const auto i = static_cast<std::size_t>(samples_[k]);
        const Vector3f& p = surface_.points[i];
        const int j =
            find_partner(moved * p, moved.rotation * surface_.normals[i], std::max<double>(reach_m, limits_.reach_m));
        if (j < 0) continue;
        const auto partner = static_cast<std::size_t>(j);
        add_pair(motion, p.cast<double>(), surface_.points[partner].cast<double>(),
                 surface_.normals[partner].cast<double>(), center_, radius_m_, equations);
      }
    }
    axis = move_axis(axis, solve_damped(equations), center_, radius_m_);
  }
  return axis;
}

}  // namespace resight::internal
