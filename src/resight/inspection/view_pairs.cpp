// SPDX-License-Identifier: Apache-2.0
#include "resight/inspection/view_pairs.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <utility>

#include "resight/core/statistics.hpp"
#include "resight/features/descriptor_index.hpp"
#include "resight/features/sift.hpp"
#include "resight/registration/pose_estimation.hpp"
#include "resight/registration/twist.hpp"
#include "resight/sensor/prepared_view.hpp"

namespace resight {
namespace {

constexpr double kMaxRatio = 0.85;
constexpr int kMinInliers = 15;
constexpr int kRefineSteps = 6;
constexpr double kBehind = 100;

/// For each query its nearest feature, if it is clearly nearer than the second nearest; otherwise -1.
std::vector<int> find_distinct_features(const FeatureSet& queries, const FeatureSet& among) {
  const DescriptorIndex index(among.descriptors, among.dimension, {.exact_below = 1 << 20});
  const std::vector<DescriptorMatch> matches = index.search(queries.descriptors, 2);
  std::vector<int> nearest(queries.size(), -1);
  for (std::size_t i = 0; i < nearest.size(); ++i) {
    const DescriptorMatch& best = matches[2 * i];
    const DescriptorMatch& next = matches[2 * i + 1];
    if (next.index >= 0 && best.distance_sq < kMaxRatio * kMaxRatio * next.distance_sq) nearest[i] = best.index;
  }
  return nearest;
}

std::vector<Correspondence> find_mutual(const FeatureSet& a, const FeatureSet& b) {
  std::vector<Correspondence> mutual;
  const std::vector<int> b_of_a = find_distinct_features(a, b);
  const std::vector<int> a_of_b = find_distinct_features(b, a);
  for (std::size_t i = 0; i < b_of_a.size(); ++i) {
    if (b_of_a[i] < 0) continue;
    const auto j = static_cast<std::size_t>(b_of_a[i]);
    if (a_of_b[j] != static_cast<int>(i)) continue;
    mutual.push_back({.model_point = a.points[i],
                      .model_normal = a.normals[i],
                      .scene_point = b.points[j],
                      .scene_normal = b.normals[j]});
  }
  return mutual;
}

}  // namespace

FeatureSet extract_view_features(RgbdFrame frame, double depth_unit_m, int num_threads) {
  for (float& z_m : frame.depth_m.data()) z_m = static_cast<float>(z_m / depth_unit_m);
  PrepareViewOptions options;
  options.min_depth_m.reset();
  options.num_threads = num_threads;
  return extract_sift(prepare_view(std::move(frame), options), {.root_sift = true});
}

ViewPair match_view_pair(int a, const FeatureSet& features_a, int b, const FeatureSet& features_b,
                         const Camera& camera) {
  ViewPair pair;
  pair.a = a;
  pair.b = b;
  if (features_a.size() < kMinInliers || features_b.size() < kMinInliers) return pair;
  const std::vector<Correspondence> mutual = find_mutual(features_a, features_b);
  // Loose: wrong intrinsics bend the scene by some percent.
  const auto pose =
      estimate_pose(mutual, {.inlier_distance_m = 0.04, .max_normal_angle_rad = 1.2, .min_inliers = kMinInliers});
  if (!pose) return pair;
  for (const int i : pose->inliers) {
    const Correspondence& c = mutual[static_cast<std::size_t>(i)];
    const Eigen::Vector3d in_a = c.model_point.cast<double>();
    const Eigen::Vector3d in_b = c.scene_point.cast<double>();
    pair.matches.push_back({camera.project(in_a), camera.project(in_b), in_a.z(), in_b.z()});
  }
  pair.b_from_a = refine_motion(pair.matches, camera, pose->scene_from_model);
  pair.error_px = median_error_px(pair.matches, camera, pair.b_from_a);
  return pair;
}

std::vector<Eigen::Vector3d> match_residuals(std::span<const MatchedPoint> matches, const Camera& camera,
                                             const Rigid3& b_from_a) {
  // No dynamic matrices: Ceres holds the same templates, compiled for other alignments.
  std::vector<Eigen::Vector3d> residuals;
  residuals.reserve(matches.size());
  for (const MatchedPoint& m : matches) {
    residuals.emplace_back(Eigen::Vector3d::Constant(kBehind));
    const Eigen::Vector3d in_b = b_from_a * camera.unproject(m.pixel_a.x(), m.pixel_a.y(), m.depth_a);
    if (in_b.z() < 1e-3 * m.depth_b) continue;
    const Eigen::Vector2d off_px = camera.project(in_b) - m.pixel_b;
    residuals.back() << off_px / kMatchSigma_px, (in_b.z() - m.depth_b) / (kMatchDepthSigma * m.depth_b);
  }
  return residuals;
}

Rigid3 refine_motion(std::span<const MatchedPoint> matches, const Camera& camera, Rigid3 b_from_a) {
  for (int step = 0; step < kRefineSteps; ++step) {
    const std::vector<Eigen::Vector3d> r = match_residuals(matches, camera, b_from_a);
    TwistMatrix normal = 1e-9 * TwistMatrix::Identity();
    Twist right = Twist::Zero();
    for (std::size_t i = 0; i < matches.size(); ++i) {
      const MatchedPoint& m = matches[i];
      const Eigen::Vector3d p = b_from_a * camera.unproject(m.pixel_a.x(), m.pixel_a.y(), m.depth_a);
      if (p.z() < 1e-3 * m.depth_b) continue;
      Eigen::Matrix3d by_point;
      by_point << camera.fx / p.z() / kMatchSigma_px, 0, -camera.fx * p.x() / (p.z() * p.z()) / kMatchSigma_px,  //
          0, camera.fy / p.z() / kMatchSigma_px, -camera.fy * p.y() / (p.z() * p.z()) / kMatchSigma_px,          //
          0, 0, 1 / (kMatchDepthSigma * m.depth_b);
      Eigen::Matrix<double, 3, 6> jacobian;
      Eigen::Matrix3d turn;  // Of p, by a small rotation.
      turn << 0, p.z(), -p.y(), -p.z(), 0, p.x(), p.y(), -p.x(), 0;
      jacobian << by_point * turn, by_point;
      const Eigen::Vector3d& at = r[i];
      const double weight = 1 / (1 + at.squaredNorm() / 9);
      normal += weight * jacobian.transpose() * jacobian;
      right -= weight * jacobian.transpose() * at;
    }
    Twist motion = normal.ldlt().solve(right);
    const Rigid3 moved = from_twist(motion);
    b_from_a = moved * b_from_a;
    if (motion.norm() < 1e-9) break;
  }
  return b_from_a;
}

double median_error_px(std::span<const MatchedPoint> matches, const Camera& camera, const Rigid3& b_from_a) {
  std::vector<double> errors_px;
  for (const Eigen::Vector3d& r : match_residuals(matches, camera, b_from_a))
    errors_px.push_back(std::min(1000.0, kMatchSigma_px * r.head<2>().norm()));
  return upper_median(std::move(errors_px));
}

}  // namespace resight
