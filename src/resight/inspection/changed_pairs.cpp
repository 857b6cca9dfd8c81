// SPDX-License-Identifier: Apache-2.0
#include "resight/inspection/internal/changed_pairs.hpp"

#include <algorithm>
#include <cstddef>

namespace resight::inspection {
namespace {

constexpr double kSameResidual = 2;     // In sigmas of a match.
constexpr double kOtherResidual = 6;    // The same: no error of the motion.
constexpr int kMinAgreeing = 5;         // Under wrong poses, no wrong match agrees with them but by chance.
constexpr double kMinDepthShare = 0.8;  // Of the depth that agrees with the motion of the pair.
constexpr double kSameMove_px = 4;      // Median distance of the matches under another motion, of images 640 px long.

/// Pose of a view, in the unit of the pairs' translations.
Rigid3 pose_of(const std::vector<Rigid3>& poses, int view, double depth_unit_m) {
  Rigid3 pose = poses[static_cast<std::size_t>(view)];
  pose.translation /= depth_unit_m;
  return pose;
}

/// Matches that agree with the given motion and not with that of the pair.
int count_agreeing(const ViewPair& pair, const Camera& camera, const Rigid3& given) {
  const std::vector<Eigen::Vector3d> under_given = match_residuals(pair.others, camera, given);
  const std::vector<Eigen::Vector3d> under_own = match_residuals(pair.others, camera, pair.b_from_a);
  int count = 0;
  for (std::size_t i = 0; i < under_given.size(); ++i)
    if (under_given[i].norm() < kSameResidual && under_own[i].norm() > kOtherResidual) ++count;
  return count;
}

}  // namespace

void mark_changed_pairs(const std::vector<Rigid3>& poses, const DepthOfViews& depths_m,
                        SequenceMeasurements& measured) {
  const double unit_m = measured.depth_unit_m;
  const double same_move_px = kSameMove_px * measured.pixel_scale();
  const auto in_metres = [&](Rigid3 motion) {
    motion.translation *= unit_m;
    return motion;
  };
  std::vector<Rigid3> moves;  // Of what has moved, in the world.
  for (ViewPair& pair : measured.pairs) {
    const Rigid3 from_a = pose_of(poses, pair.a, unit_m), from_b = pose_of(poses, pair.b, unit_m);
    const Rigid3 given = from_b.inverse() * from_a;
    if (median_error_px(pair.matches, measured.camera, given) < same_move_px ||
        count_agreeing(pair, measured.camera, given) < kMinAgreeing)
      continue;
    const Image<float>&depth_a = depths_m.at(pair.a), &depth_b = depths_m.at(pair.b);
    const int as_given = count_same_depth(depth_a, depth_b, measured.camera, in_metres(given));
    const int as_matched = count_same_depth(depth_a, depth_b, measured.camera, in_metres(pair.b_from_a));
    pair.shows_change = as_given > kMinDepthShare * as_matched;
    if (pair.shows_change) moves.push_back(from_b * pair.b_from_a * from_a.inverse());
  }
  // Where few matches are left, those on the moved thing still tell of the same move.
  for (std::vector<ViewPair>* pairs : {&measured.pairs, &measured.far_pairs})
    for (ViewPair& pair : *pairs) {
      const Rigid3 from_a = pose_of(poses, pair.a, unit_m), b_from_world = pose_of(poses, pair.b, unit_m).inverse();
      if (median_error_px(pair.matches, measured.camera, b_from_world * from_a) < same_move_px) continue;
      pair.shows_change |= std::ranges::any_of(moves, [&](const Rigid3& move) {
        return median_error_px(pair.matches, measured.camera, b_from_world * move * from_a) < same_move_px;
      });
    }
}

}  // namespace resight::inspection
