// SPDX-License-Identifier: Apache-2.0
#include "resight/inspection/view_pairs.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "resight/core/statistics.hpp"
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

}  // namespace

ViewFeatures extract_view_features(RgbdFrame frame, double depth_unit_m, int num_threads) {
  for (float& z_m : frame.depth_m.data()) z_m = static_cast<float>(z_m / depth_unit_m);
  PrepareViewOptions options;
  options.min_depth_m.reset();
  options.num_threads = num_threads;
  return ViewFeatures(extract_sift(prepare_view(std::move(frame), options), {.root_sift = true}));
}

ViewPair match_view_pair(int a, const ViewFeatures& features_a, int b, const ViewFeatures& features_b,
                         const Camera& camera) {
  ViewPair pair;
  pair.a = a;
  pair.b = b;
  const FeatureSet& in_a = features_a.features();
  const FeatureSet& in_b = features_b.features();
  if (in_a.size() < kMinInliers || in_b.size() < kMinInliers) return pair;
  std::vector<Correspondence> mutual;
  for (const FeaturePair& match : find_mutual_matches(features_a, features_b, kMaxRatio)) {
    const auto of_a = static_cast<std::size_t>(match.a);
    const auto of_b = static_cast<std::size_t>(match.b);
    mutual.push_back({.model_point = in_a.points[of_a],
                      .model_normal = in_a.normals[of_a],
                      .scene_point = in_b.points[of_b],
                      .scene_normal = in_b.normals[of_b]});
  }
  // Loose: wrong intrinsics bend the scene by some percent.
  const auto pose =
      estimate_pose(mutual, {.inlier_distance_m = 0.04, .max_normal_angle_rad = 1.2, .min_inliers = kMinInliers});
  if (!pose) return pair;
  std::vector<bool> agrees(mutual.size());
  for (const int i : pose->inliers) agrees[static_cast<std::size_t>(i)] = true;
  for (std::size_t i = 0; i < mutual.size(); ++i) {
    const Eigen::Vector3d p_in_a = mutual[i].model_point.cast<double>();
    const Eigen::Vector3d p_in_b = mutual[i].scene_point.cast<double>();
    (agrees[i] ? pair.matches : pair.others)
        .push_back({camera.project(p_in_a), camera.project(p_in_b), p_in_a.z(), p_in_b.z()});
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

int count_same_depth(const Image<float>& depth_a, const Image<float>& depth_b, const Camera& camera,
                     const Rigid3& b_from_a) {
  constexpr int kSpacing_px = 4;
  constexpr double kMaxDifference = 0.01;
  int num_same = 0;
  for (int v = 0; v < depth_a.height(); v += kSpacing_px)
    for (int u = 0; u < depth_a.width(); u += kSpacing_px) {
      if (!(depth_a(u, v) > 0)) continue;
      const Eigen::Vector3d in_b = b_from_a * camera.unproject(u, v, depth_a(u, v));
      const std::optional<Pixel> pixel = camera.pixel_of(in_b);
      if (!pixel) continue;
      const float seen = depth_b(pixel->u, pixel->v);
      if (std::abs(seen - in_b.z()) < kMaxDifference * in_b.z()) ++num_same;
    }
  return num_same;
}

}  // namespace resight
