// SPDX-License-Identifier: Apache-2.0
#include "resight/modelling/internal/align_shapes.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "resight/core/parallel.hpp"
#include "resight/geometry/fibonacci_sphere.hpp"
#include "resight/geometry/kd_tree.hpp"
#include "resight/registration/point_to_plane.hpp"
#include "resight/registration/twist.hpp"

namespace resight {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;

constexpr double kSameFit_m = 0.01;

// A surface with its search tree and some sample points.
struct Shape {
  explicit Shape(const TriangleMesh& mesh, int num_samples)
      : points(mesh.vertices), normals(with_normals(mesh).normals), tree(points) {
    Vector3f low = points[0], high = points[0];
    for (const Vector3f& p : points) {
      low = low.cwiseMin(p);
      high = high.cwiseMax(p);
    }
    middle = (0.5F * (low + high)).cast<double>();
    radius_m = 0.5 * (high - low).cast<double>().norm();
    const auto wanted = std::min(points.size(), static_cast<std::size_t>(num_samples));
    for (std::size_t k = 0; k < wanted; ++k) samples.push_back(k * points.size() / wanted);
  }

  static TriangleMesh with_normals(TriangleMesh mesh) {
    if (mesh.normals.size() != mesh.vertices.size()) compute_vertex_normals(mesh);
    return mesh;
  }

  std::vector<Vector3f> points;
  std::vector<Vector3f> normals;
  KdTree tree;
  std::vector<std::size_t> samples;
  Vector3d middle;
  double radius_m = 0;
};

// Calls `pair(moved point, index in fixed)` for each sample of `moving` that agrees with a point of `fixed`.
template <typename Pair>
void find_pairs(const Shape& fixed, const Shape& moving, const Rigid3& pose, double max_distance_m, double min_cosine,
                const Pair& pair) {
  const Rigid3f p(pose);
  for (const std::size_t s : moving.samples) {
    const Vector3f moved = p * moving.points[s];
    const PointNeighbor nearest = fixed.tree.nearest(moved);
    if (nearest.distance_sq > max_distance_m * max_distance_m) continue;
    if ((p.rotation * moving.normals[s]).dot(fixed.normals[nearest.index]) < min_cosine) continue;
    pair(moved, nearest.index);
  }
}

bool are_same(const Rigid3& a, const Rigid3& b, const Shape& moving) {
  return std::ranges::all_of(moving.samples, [&](std::size_t s) {
    const Vector3d p = moving.points[s].cast<double>();
    return (a * p - b * p).norm() < kSameFit_m;
  });
}

// The last pose, or that on the way at which most points agree if the pose has moved away from it: what the shapes
// leave free, such as a shift along the axis of a round object, follows the parts that only one of them has.
Rigid3 improve(const Shape& fixed, const Shape& moving, Rigid3 pose, const AlignShapesOptions& options) {
  Rigid3 best = pose;
  int most = 0;
  const double max_distance_sq = options.max_distance_m * options.max_distance_m;
  for (int k = 0; k <= options.num_iterations; ++k) {
    const double left = std::max(0.0, 1 - static_cast<double>(k) / (options.num_iterations - 1));
    const double reach_m = options.max_distance_m + 0.3 * fixed.radius_m * left * left;
    int num = 0;
    NormalEquations equations;
    equations.matrix = Matrix6::Identity() * 1e-6;  // So that what the shapes leave free has a solution.
    find_pairs(fixed, moving, pose, reach_m, std::cos(options.max_normal_angle_rad), [&](const Vector3f& p, int i) {
      num += (p - fixed.points[i]).squaredNorm() <= max_distance_sq ? 1 : 0;
      const Vector3d at = p.cast<double>() - fixed.middle;
      const Vector3d normal = fixed.normals[i].cast<double>();
      equations.add_row(point_to_plane_row(at, normal), normal.dot((p - fixed.points[i]).cast<double>()));
    });
    if (num >= most) best = pose;
    most = std::max(most, num);
    if (k == options.num_iterations) break;
    const Rigid3 to_middle = Rigid3::from_translation(fixed.middle);
    pose = to_middle * from_twist(-equations.matrix.ldlt().solve(equations.right)) * to_middle.inverse() * pose;
  }
  if (!are_same(best, pose, moving)) pose = best;
  pose.rotation = nearest_rotation(pose.rotation);
  return pose;
}

double agreement(const Shape& fixed, const Shape& moving, const Rigid3& pose, const AlignShapesOptions& options) {
  const double min_cosine = std::cos(options.max_normal_angle_rad);
  double num = 0;
  const auto count = [&](const Vector3f&, int) { ++num; };
  find_pairs(fixed, moving, pose, options.max_distance_m, min_cosine, count);
  find_pairs(moving, fixed, pose.inverse(), options.max_distance_m, min_cosine, count);
  return num / static_cast<double>(fixed.samples.size() + moving.samples.size());
}

// Directions uniformly over the sphere, each combined with rotations about it.
std::vector<Eigen::Matrix3d> choose_rotations(const AlignShapesOptions& options) {
  std::vector<Eigen::Matrix3d> rotations;
  for (int d = 0; d < options.num_directions; ++d) {
    const Eigen::Quaterniond tilt =
        Eigen::Quaterniond::FromTwoVectors(Vector3d::UnitZ(), fibonacci_direction(d, options.num_directions));
    for (int t = 0; t < options.num_rotations; ++t)
      rotations.emplace_back(tilt *
                             Eigen::AngleAxisd(2 * std::numbers::pi * t / options.num_rotations, Vector3d::UnitZ()));
  }
  return rotations;
}

}  // namespace

std::vector<ShapeFit> align_shapes(const TriangleMesh& fixed, const TriangleMesh& moving,
                                   const AlignShapesOptions& options) {
  if (fixed.vertices.empty() || moving.vertices.empty()) return {};
  const Shape to(fixed, options.num_samples), from(moving, options.num_samples);
  const std::vector<Eigen::Matrix3d> rotations = choose_rotations(options);
  std::vector<ShapeFit> all(rotations.size());
  parallel_for(all.size(), options.num_threads, [&](std::size_t k) {
    const Rigid3 start{rotations[k], to.middle - rotations[k] * from.middle};
    all[k].fixed_from_moving = improve(to, from, start, options);
    all[k].agreement = agreement(to, from, all[k].fixed_from_moving, options);
  });
  std::ranges::stable_sort(all, std::greater{}, &ShapeFit::agreement);
  std::vector<ShapeFit> fits;
  for (const ShapeFit& fit : all) {
    if (static_cast<int>(fits.size()) == options.max_fits) break;
    if (std::ranges::none_of(
            fits, [&](const ShapeFit& f) { return are_same(f.fixed_from_moving, fit.fixed_from_moving, from); }))
      fits.push_back(fit);
  }
  return fits;
}

}  // namespace resight
