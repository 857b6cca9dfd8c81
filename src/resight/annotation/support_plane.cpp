// SPDX-License-Identifier: Apache-2.0
#include "resight/annotation/internal/support_plane.hpp"

#include <Eigen/Eigenvalues>
#include <cmath>
#include <vector>

#include "resight/core/random.hpp"

namespace resight {
namespace {

constexpr int kClickRadius_px = 6;
constexpr std::size_t kMaxPlanePoints = 3000;
constexpr int kNumTriples = 400;
constexpr double kPlaneTolerance_m = 0.008;
constexpr double kMinPlaneShare = 0.1;
constexpr double kMinFacing = 0.1;  // Cosine to the ray: no planes seen edge-on.

std::vector<Eigen::Vector3d> collect_neighbors(const RgbdFrame& frame, const Eigen::Vector3d& middle, double radius_m) {
  std::vector<Eigen::Vector3d> near;
  for (int v = 0; v < frame.camera.height; v += 2)
    for (int u = 0; u < frame.camera.width; u += 2) {
      const float z = frame.depth_m(u, v);
      if (std::isnan(z)) continue;
      const Eigen::Vector3d p = frame.camera.unproject(u, v, static_cast<double>(z));
      if ((p - middle).squaredNorm() < radius_m * radius_m) near.push_back(p);
    }
  const std::size_t step = 1 + near.size() / kMaxPlanePoints;
  std::vector<Eigen::Vector3d> kept;
  for (std::size_t i = 0; i < near.size(); i += step) kept.push_back(near[i]);
  return kept;
}

int count_on_plane(const std::vector<Eigen::Vector3d>& points, const SupportPlane& plane, double tolerance_m) {
  int count = 0;
  for (const Eigen::Vector3d& p : points) count += std::abs(plane.signed_distance_m(p)) < tolerance_m ? 1 : 0;
  return count;
}

/// Least-squares plane through the points near a plane.
SupportPlane fit_plane(const std::vector<Eigen::Vector3d>& points, SupportPlane plane) {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  std::vector<Eigen::Vector3d> on_plane;
  for (const Eigen::Vector3d& p : points)
    if (std::abs(plane.signed_distance_m(p)) < kPlaneTolerance_m) on_plane.push_back(p);
  for (const Eigen::Vector3d& p : on_plane) mean += p / static_cast<double>(on_plane.size());
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  for (const Eigen::Vector3d& p : on_plane) covariance += (p - mean) * (p - mean).transpose();
  const Eigen::Vector3d normal = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(covariance).eigenvectors().col(0);
  plane.normal = normal.dot(plane.normal) < 0 ? Eigen::Vector3d(-normal) : normal;
  plane.offset_m = plane.normal.dot(mean);
  return plane;
}

}  // namespace

std::optional<Eigen::Vector3d> find_clicked_point(const RgbdFrame& frame, Pixel pixel) {
  int best_sq = (kClickRadius_px + 1) * (kClickRadius_px + 1);
  std::optional<Eigen::Vector3d> found;
  for (int dv = -kClickRadius_px; dv <= kClickRadius_px; ++dv)
    for (int du = -kClickRadius_px; du <= kClickRadius_px; ++du) {
      const int u = pixel.u + du;
      const int v = pixel.v + dv;
      if (!frame.depth_m.contains(u, v) || du * du + dv * dv >= best_sq || std::isnan(frame.depth_m(u, v))) continue;
      best_sq = du * du + dv * dv;
      found = frame.camera.unproject(u, v, static_cast<double>(frame.depth_m(u, v)));
    }
  return found;
}

SupportPlane find_support_plane(const RgbdFrame& frame, const Eigen::Vector3d& point_in_camera, double radius_m) {
  const auto points = collect_neighbors(frame, point_in_camera, radius_m);
  SupportPlane best;
  best.normal = -point_in_camera.normalized();
  best.offset_m = best.normal.dot(point_in_camera);
  int best_count = static_cast<int>(kMinPlaneShare * static_cast<double>(points.size()));
  if (points.size() < 50) return best;
  Rng rng(1);
  bool is_found = false;
  for (int i = 0; i < kNumTriples; ++i) {
    const auto draw = [&]() -> const Eigen::Vector3d& { return points[rng.next() % points.size()]; };
    const Eigen::Vector3d& a = draw();
    SupportPlane plane;
    plane.normal = (draw() - a).cross(draw() - a);
    if (plane.normal.norm() < 1e-6) continue;
    plane.normal.normalize();
    if (plane.normal.dot(a) > 0) plane.normal = -plane.normal;
    if (-plane.normal.dot(a.normalized()) < kMinFacing) continue;
    plane.offset_m = plane.normal.dot(a);
    if (plane.signed_distance_m(point_in_camera) < -2 * kPlaneTolerance_m) continue;
    const int count = count_on_plane(points, plane, kPlaneTolerance_m);
    if (count <= best_count) continue;
    best_count = count;
    best = plane;
    is_found = true;
  }
  return is_found ? fit_plane(points, best) : best;
}

}  // namespace resight
