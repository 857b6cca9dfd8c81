// SPDX-License-Identifier: Apache-2.0
#include "resight/inspection/quick_check.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "resight/inspection/find_faults.hpp"

namespace resight {
namespace {

constexpr int kStep_px = 8;
constexpr double kSameDepth = 0.05;  // Depths of one surface differ by less; those of unrelated views rarely agree.
constexpr double kMinMove_rad = 0.2;
constexpr double kMinMove = 0.05;       // Of the median depth.
constexpr double kMaxGivenShare = 0.5;  // Good poses: 0.8 and more of what both views see.
constexpr double kMinOtherShare = 0.75;
constexpr int kMinPixels = 300;

/// Share of the pixels of a that lie in view b at the depth that it measured, of those that it sees; 0 if it sees few.
double agreeing_share(const RgbdFrame& a, const RgbdFrame& b, const Rigid3& b_from_a) {
  int num_seen = 0, num_same = 0;
  for (int v = 0; v < a.depth_m.height(); v += kStep_px)
    for (int u = 0; u < a.depth_m.width(); u += kStep_px) {
      if (std::isnan(a.depth_m(u, v))) continue;
      const Eigen::Vector3d in_b = b_from_a * a.camera.unproject(u, v, a.depth_m(u, v));
      const std::optional<Pixel> pixel = b.camera.pixel_of(in_b);
      if (!pixel || std::isnan(b.depth_m(pixel->u, pixel->v))) continue;
      ++num_seen;
      if (std::abs(b.depth_m(pixel->u, pixel->v) - in_b.z()) < kSameDepth * in_b.z()) ++num_same;
    }
  return num_seen < kMinPixels ? 0 : static_cast<double>(num_same) / num_seen;
}

/// The first view from which the camera has moved so far that readings of the poses differ.
std::optional<int> find_moved_view(const Sequence& sequence, const Rigid3& first, double depth_m) {
  for (int v = 1; v < sequence.num_views(); ++v) {
    const auto pose = sequence.read_pose(v);
    if (!pose.ok()) return std::nullopt;
    if ((pose->translation - first.translation).norm() > kMinMove * depth_m ||
        rotation_angle_rad(pose->rotation, first.rotation) > kMinMove_rad)
      return v;
  }
  return std::nullopt;
}

void check_poses(const RgbdFrame& a, const RgbdFrame& b, int view, std::vector<Finding>& findings) {
  const Rigid3& from_a = a.world_from_camera;
  const Rigid3& from_b = b.world_from_camera;
  const double given = agreeing_share(a, b, from_b.inverse() * from_a);
  if (given > kMaxGivenShare) return;
  Rigid3 shorter = from_b.inverse() * from_a;
  shorter.translation *= 1e-3;
  const double inverted = agreeing_share(a, b, from_b * from_a.inverse());
  const double in_mm = agreeing_share(a, b, shorter);
  const Eigen::Matrix3d flip = Eigen::Vector3d(1, -1, -1).asDiagonal();
  const Rigid3 y_up = Rigid3::from_rotation(flip);
  const double opengl = agreeing_share(a, b, (from_b * y_up).inverse() * (from_a * y_up));
  const double other = std::max({inverted, in_mm, opengl});
  if (other < kMinOtherShare) return;
  const bool is_inverted = inverted == other;
  const bool is_in_mm = !is_inverted && in_mm == other;
  findings.push_back({.fault = is_in_mm ? "pose_unit" : "pose_convention",
                      .message = fmt::format(
                          "the depths of two views agree at {:.0f} % of the pixels, and at {:.0f} % if the poses are "
                          "{}",
                          100 * given, 100 * other,
                          is_in_mm      ? "in millimetres"
                          : is_inverted ? "world to camera"
                                        : "those of a camera with y up"),
                      .remedy = is_in_mm      ? "divide the translations by 1000"
                                : is_inverted ? "--pose-convention world-to-camera"
                                              : "--pose-convention opengl",
                      .value = other,
                      .unit = "",
                      .threshold = kMinOtherShare,
                      .margin = other / kMinOtherShare,
                      .view = view});
}

}  // namespace

std::vector<Finding> check_quickly(const Sequence& sequence, bool uses_poses) {
  const auto first = sequence.read_view(0);
  if (!first.ok()) return {};
  std::vector<Finding> findings = find_view_faults(*first);
  if (!findings.empty() || !uses_poses || !sequence.has_poses()) return findings;
  const double depth_m = measure_depth_values(first->depth_m).median_m;
  const auto moved = find_moved_view(sequence, first->world_from_camera, depth_m);
  if (!moved) return findings;
  const auto other = sequence.read_view(*moved);
  if (other.ok()) check_poses(*first, *other, *moved, findings);
  return findings;
}

}  // namespace resight
