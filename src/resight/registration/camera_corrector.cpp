// SPDX-License-Identifier: Apache-2.0
#include "resight/registration/camera_corrector.hpp"

#include <algorithm>
#include <utility>
#include <vector>

#include "resight/core/check.hpp"
#include "resight/registration/twist.hpp"

namespace resight {

void CorrectCameraOptions::check() const {
  check_positive("num_views", num_views);
  check_positive("sigma_m", sigma_m);
  check_positive("sigma_rad", sigma_rad);
  check_in_range("min_overlap", min_overlap, 0, 1);
  check_not_negative("min_surprise", min_surprise);
  check_positive("max_sigmas", max_sigmas);
  view.check();
  align.check();
}

CameraCorrector::CameraCorrector(const CorrectCameraOptions& options) : options_(options) {
  options_.check();
  options_.align.prior_sigma_m = options_.sigma_m;
  options_.align.prior_sigma_rad = options_.sigma_rad;
}

Rigid3 CameraCorrector::add_view(const PreparedView& view) {
  if (!options_.enabled) return view.frame.world_from_camera;
  View added{make_alignment_view(view, options_.view), view.frame.world_from_camera};
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
  AlignViewOptions near = options_.align;
  near.num_levels = 1;
  if (!is_surprising(align_view(view, targets, world_from_camera, near), world_from_camera)) return world_from_camera;
  const AlignedView aligned = align_view(view, targets, world_from_camera, options_.align);
  const AlignedView given = judge_alignment(view, targets, world_from_camera, options_.align);
  if (aligned.overlap < std::max(options_.min_overlap, given.overlap)) return world_from_camera;
  const Twist off = to_twist(aligned.world_from_camera.inverse() * world_from_camera);
  const bool too_far = off.head<3>().norm() > options_.max_sigmas * options_.sigma_rad ||
                       off.tail<3>().norm() > options_.max_sigmas * options_.sigma_m;
  return too_far || !is_surprising(aligned, world_from_camera) ? world_from_camera : aligned.world_from_camera;
}

bool CameraCorrector::is_surprising(const AlignedView& aligned, const Rigid3& world_from_camera) const {
  const Twist off = to_twist(aligned.world_from_camera.inverse() * world_from_camera);
  return off.dot(aligned.information * off) > options_.min_surprise;
}

}  // namespace resight
