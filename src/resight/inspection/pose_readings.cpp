// SPDX-License-Identifier: Apache-2.0
#include "resight/inspection/pose_readings.hpp"

#include <algorithm>
#include <utility>

namespace resight {
namespace {

/// Pose between two views, linear in translation and rotation.
std::optional<Rigid3> pose_at(const std::vector<Rigid3>& poses, double view) {
  if (view < 0 || view > static_cast<double>(poses.size() - 1)) return std::nullopt;
  const auto before = static_cast<std::size_t>(view);
  const double share = view - static_cast<double>(before);
  if (share == 0) return poses[before];
  return interpolate(poses[before], poses[before + 1], share);
}

Rigid3 read_as(const Rigid3& pose, const PoseReading& reading) {
  const Rigid3 world_from_camera = reading.inverted ? pose.inverse() : pose;
  if (!reading.opengl) return world_from_camera;
  const Eigen::Matrix3d flip = Eigen::Vector3d(1, -1, -1).asDiagonal();
  return world_from_camera * Rigid3::from_rotation(flip);
}

GivenMotion motion_of(const std::vector<Rigid3>& poses, const PoseReading& reading, double depth_unit_m) {
  return [&poses, reading, depth_unit_m](const ViewPair& pair) -> std::optional<Rigid3> {
    const std::optional<Rigid3> a = pose_at(poses, pair.a + reading.views_late);
    const std::optional<Rigid3> b = pose_at(poses, pair.b + reading.views_late);
    if (!a || !b) return std::nullopt;
    Rigid3 b_from_a = read_as(*b, reading).inverse() * read_as(*a, reading);
    b_from_a.translation /= depth_unit_m;
    return b_from_a;
  };
}

}  // namespace

Result<std::vector<Rigid3>> read_poses(const Sequence& sequence) {
  std::vector<Rigid3> poses;
  for (int v = 0; v < sequence.num_views(); ++v) {
    auto pose = sequence.read_pose(v);
    if (!pose.ok()) return pose.error();
    poses.push_back(*pose);
  }
  return poses;
}

PoseMeasurements measure_poses(const std::vector<Rigid3>& poses, const SequenceMeasurements& measured) {
  PoseMeasurements result;
  Eigen::AlignedBox3d box;
  for (const Rigid3& pose : poses) {
    box.extend(pose.translation);
    result.farthest_m = std::max(result.farthest_m, pose.translation.norm());
  }
  result.extent_m = box.sizes().norm();
  result.all_equal = std::ranges::all_of(poses, [&](const Rigid3& p) { return is_same_pose(p, poses.front()); });
  const auto motion = [&](const PoseReading& r) { return motion_of(poses, r, measured.depth_unit_m); };
  result.given = evaluate_poses(measured.pairs, measured.camera, motion({}));
  if (result.all_equal) return result;
  result.far = fit_pose_scale(measured.far_pairs, measured.camera, motion({}));
  for (const bool inverted : {false, true})
    for (const bool opengl : {false, true}) {
      const PoseReading reading{.inverted = inverted, .opengl = opengl, .views_late = 0};
      result.readings.push_back({reading, fit_pose_scale(measured.pairs, measured.camera, motion(reading))});
    }
  constexpr int kMaxQuarters = 16;
  for (int quarters = -kMaxQuarters; quarters <= kMaxQuarters; ++quarters) {
    const PoseReading reading{.inverted = false, .opengl = false, .views_late = 0.25 * quarters};
    GivenPosesFit fit = evaluate_poses(measured.pairs, measured.camera, motion(reading));
    // Fewer pairs may agree by chance.
    if (2 * fit.pair_errors_px.size() >= result.given.pair_errors_px.size())
      result.shifted.push_back({reading, std::move(fit)});
  }
  return result;
}

}  // namespace resight
