// SPDX-License-Identifier: Apache-2.0
#include "resight/registration/camera_corrector.hpp"

#include <algorithm>
#include <utility>
#include <vector>

#include "resight/registration/twist.hpp"

namespace resight {
namespace {

// Squared Mahalanobis distance between given and aligned pose below which the given one stands: chi-squared with 6
// degrees of freedom, one in 1,000 by chance.
constexpr double kMinMahalanobis_sq = 22.5;
// A given pose is not off by more standard deviations: then it is the alignment that is wrong.
constexpr double kMaxSigmas = 4;

}  // namespace

CameraCorrector::CameraCorrector(const CorrectCameraOptions& options) : options_(options) {
  options_.check();
  align_.max_distance_m = options_.max_distance_m;
  align_.brightness_sigma = options_.brightness_sigma.value_or(0);
  align_.num_threads = options_.num_threads;
  align_.prior_sigma_m = options_.sigma_m;
  align_.prior_sigma_rad = options_.sigma_rad;
}

Rigid3 CameraCorrector::add_view(const PreparedView& view) {
  if (!options_.correct) return view.frame.world_from_camera;
  View added{make_alignment_view(view), view.frame.world_from_camera};
  if (!added.view.levels.empty()) added.world_from_camera = correct(added.view, added.world_from_camera);
  views_.push_back(std::move(added));
  if (views_.size() > static_cast<std::size_t>(options_.num_views)) views_.pop_front();
  return views_.back().world_from_camera;
}

Rigid3 CameraCorrector::correct(const AlignmentView& view, const Rigid3& world_from_camera) const {
  std::vector<AlignmentTarget> targets;
  for (const View& earlier : views_)
    if (earlier.view.levels.size() >= view.levels.size()) targets.push_back({&earlier.view, earlier.world_from_camera});
  if (targets.empty()) return world_from_camera;
  // Most given poses are right; the finest level alone confirms them.
  AlignViewOptions near = align_;
  near.num_levels = 1;
  if (!is_surprising(align_view(view, targets, world_from_camera, near), world_from_camera)) return world_from_camera;
  const AlignedView aligned = align_view(view, targets, world_from_camera, align_);
  const AlignedView given = evaluate_alignment(view, targets, world_from_camera, align_);
  if (aligned.overlap < std::max(options_.min_overlap, given.overlap)) return world_from_camera;
  const Twist off = to_twist(aligned.world_from_camera.inverse() * world_from_camera);
  const bool too_far =
      off.head<3>().norm() > kMaxSigmas * options_.sigma_rad || off.tail<3>().norm() > kMaxSigmas * options_.sigma_m;
  return too_far || !is_surprising(aligned, world_from_camera) ? world_from_camera : aligned.world_from_camera;
}

bool CameraCorrector::is_surprising(const AlignedView& aligned, const Rigid3& world_from_camera) const {
  const Twist off = to_twist(aligned.world_from_camera.inverse() * world_from_camera);
  return off.dot(aligned.information * off) > kMinMahalanobis_sq;
}

}  // namespace resight
