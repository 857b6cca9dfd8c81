// SPDX-License-Identifier: Apache-2.0
#include "resight/registration/camera_corrector.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "resight/registration/twist.hpp"

namespace resight {
namespace {

// Squared Mahalanobis distance between given and aligned pose below which the given one is kept: chi-squared with 6
// degrees of freedom, one in 1,000 by chance.
constexpr double kMinMahalanobis_sq = 22.5;
// A given motion is not off by more standard deviations: then it is the alignment that is wrong.
constexpr double kMaxSigmas = 4;
// A camera whose given pose does not change stands still, where it was found to be. What changes in front of it must
// not move it: an aligned pose must fit the views before better by a tenth. This rule is not for a moving camera: exact
// poses pass the test above, and poses of a tracker drift.
constexpr double kMaxCostRatioOfStill = 0.9;
// A pose that fits better must not do so by turning away from what contradicts it. The overlap of right poses varies by
// a hundredth.
constexpr double kMinOverlapRatio = 0.95;
// Grey levels (Steinbruecker et al. 2011). Along planes, only brightness tells how the camera moved; but it misleads
// where exposure changes, or colour is not exactly registered with depth. The fit of the depths decides.
constexpr double kBrightnessSigma = 12;

// By how much the pose was moved. One that is not measured may be, too: it follows the last one that was.
void tell_motion(const Rigid3& given, CorrectedCamera& camera) {
  if (is_same_pose(camera.world_from_camera, given)) return;
  const Twist moved = to_twist(camera.world_from_camera.inverse() * given);
  camera.correction.moved_rad = moved.head<3>().norm();
  camera.correction.moved_m = moved.tail<3>().norm();
}

}  // namespace

CameraCorrector::CameraCorrector(const CorrectCameraOptions& options) : options_(options) {
  options_.check();
  align_.max_distance_m = options_.max_distance_m;
  align_.brightness_sigma = 0;
  align_.num_threads = options_.num_threads;
  align_.prior_sigma_m = options_.sigma_m;
  align_.prior_sigma_rad = options_.sigma_rad;
}

CorrectedCamera CameraCorrector::add_view(const PreparedView& view) {
  const Rigid3& given = view.frame.world_from_camera;
  if (!options_.correct || options_.fixed) return {given, {}};
  CorrectedCamera camera{predict(given), {}};
  if (count_valid(view.frame.depth_m) > 0) {
    View added{make_alignment_view(view), given, given, false};
    if (!added.view.levels.empty()) camera = correct(added.view, given);
    added.world_from_camera = camera.world_from_camera;
    added.is_measured = camera.correction.is_measured;
    views_.push_back(std::move(added));
    if (views_.size() > static_cast<std::size_t>(options_.num_views)) views_.pop_front();
  }
  tell_motion(given, camera);
  return camera;
}

// The last view whose pose was measured; without any, the last one.
const CameraCorrector::View& CameraCorrector::last_known() const {
  const auto known = std::find_if(views_.rbegin(), views_.rend(), [](const View& v) { return v.is_measured; });
  return known == views_.rend() ? views_.back() : *known;
}

// Poses of a tracker drift: the motion since the last known pose is known better than the pose.
Rigid3 CameraCorrector::predict(const Rigid3& given) const {
  if (views_.empty()) return given;
  const View& last = last_known();
  if (is_same_pose(last.world_from_camera, last.given)) return given;
  if (is_same_pose(last.given, given)) return last.world_from_camera;
  return last.world_from_camera * (last.given.inverse() * given);
}

CorrectedCamera CameraCorrector::correct(const AlignmentView& view, const Rigid3& given) const {
  const Rigid3 predicted = predict(given);
  std::vector<AlignmentTarget> targets;
  for (const View& earlier : views_)
    if (earlier.view.levels.size() >= view.levels.size()) targets.push_back({&earlier.view, earlier.world_from_camera});
  if (targets.empty()) return {predicted, {}};
  const bool is_still = is_same_pose(last_known().given, given);
  const Rigid3& expected = is_still ? predicted : given;
  // Most expected poses are right; the finest level alone confirms them. It says nothing about directions in which the
  // surfaces are farther off than its pairs may be.
  AlignViewOptions near = align_;
  near.num_levels = 1;
  const AlignedView finest = align_view(view, targets, expected, near);
  if (is_constrained(finest) && !is_surprising(finest, expected)) return {expected, measure(finest)};
  const AlignedView as_expected = evaluate_alignment(view, targets, expected, align_);
  AlignedView best = as_expected;
  const double min_overlap = std::max(options_.min_overlap, kMinOverlapRatio * as_expected.overlap);
  const auto consider = [&](const AlignedView& found) {
    if (found.overlap >= min_overlap && found.cost < best.cost) best = found;
  };
  if (!is_same_pose(predicted, expected)) consider(evaluate_alignment(view, targets, predicted, align_));
  for (const Rigid3& start : {predicted, given}) {
    for (const double brightness_sigma : {0.0, kBrightnessSigma}) {
      AlignViewOptions align = align_;
      align.brightness_sigma = brightness_sigma;
      const AlignedView aligned = align_view(view, targets, start, align);
      if (!is_too_far(aligned, start)) consider(aligned);
    }
    if (is_same_pose(predicted, given)) break;
  }
  const double max_cost = as_expected.cost * (is_still ? kMaxCostRatioOfStill : 1);
  const bool is_off = best.cost < max_cost && is_surprising(best, expected);
  if (!is_off && as_expected.overlap < options_.min_overlap) return {predicted, {}};
  const Rigid3& corrected = is_off ? best.world_from_camera : expected;
  return {corrected, measure(best)};
}

PoseCorrection CameraCorrector::measure(const AlignedView& aligned) const {
  PoseCorrection correction;
  if (aligned.overlap < options_.min_overlap) return correction;
  // What the surfaces leave open, the given pose tells.
  const TwistMatrix information = aligned.information + twist_information(options_.sigma_rad, options_.sigma_m);
  const Twist variances = information.inverse().diagonal();
  correction.is_measured = true;
  correction.sigma_rad = std::sqrt(variances.head<3>().mean());
  correction.sigma_m = std::sqrt(variances.tail<3>().mean());
  return correction;
}

bool CameraCorrector::is_too_far(const AlignedView& aligned, const Rigid3& start) const {
  const Twist off = to_twist(aligned.world_from_camera.inverse() * start);
  return off.head<3>().norm() > kMaxSigmas * options_.sigma_rad || off.tail<3>().norm() > kMaxSigmas * options_.sigma_m;
}

bool CameraCorrector::is_constrained(const AlignedView& aligned) const {
  constexpr double kMaxShareOfPrior = 0.5;
  const TwistMatrix prior = twist_information(options_.sigma_rad, options_.sigma_m);
  const TwistMatrix covariance = (aligned.information + prior).inverse();
  return (covariance.diagonal().array() * prior.diagonal().array()).maxCoeff() < kMaxShareOfPrior * kMaxShareOfPrior;
}

bool CameraCorrector::is_surprising(const AlignedView& aligned, const Rigid3& world_from_camera) const {
  const Twist off = to_twist(aligned.world_from_camera.inverse() * world_from_camera);
  return off.dot(aligned.information * off) > kMinMahalanobis_sq;
}

}  // namespace resight
