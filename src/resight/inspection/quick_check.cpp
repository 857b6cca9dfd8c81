// SPDX-License-Identifier: Apache-2.0
#include "resight/inspection/quick_check.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <optional>
#include <set>
#include <tuple>
#include <utility>

#include "resight/inspection/find_faults.hpp"

namespace resight {
namespace {

constexpr int kStep_px = 8;
constexpr double kSameDepth = 0.05;  // Depths of one surface differ by less; those of unrelated views rarely agree.
constexpr double kMinMove_rad = 0.2;
constexpr double kMinMove = 0.05;         // Of the median depth.
constexpr double kMinMoveInMetres = 0.1;  // Of the median depth.
constexpr int kMaxNearViews = 4;
constexpr double kGoodShare = 0.8;      // Good poses: this and more of what both views see.
constexpr double kMaxGivenShare = 0.6;  // More may be chance: smooth surfaces agree nearly, and poses may be coarse.
constexpr double kMaxRest = 0.25;       // Of the disagreement, that another reading must leave then.
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

/// Another reading of the poses or of the depth. Depth of another unit is the same as translations of another unit.
struct Reading {
  const char* fault;
  const char* condition;
  const char* remedy;
  Rigid3 b_from_a;
};

std::vector<Reading> other_readings(const Rigid3& from_a, const Rigid3& from_b) {
  const Eigen::Matrix3d flip = Eigen::Vector3d(1, -1, -1).asDiagonal();
  const Rigid3 y_up = Rigid3::from_rotation(flip);
  const auto longer = [&](double factor) {
    Rigid3 b_from_a = from_b.inverse() * from_a;
    b_from_a.translation *= factor;
    return b_from_a;
  };
  return {
      {"pose_convention", "the poses are world to camera", "--pose-convention world-to-camera",
       from_b * from_a.inverse()},
      {"pose_convention", "the poses are those of a camera with y up", "--pose-convention opengl",
       (from_b * y_up).inverse() * (from_a * y_up)},
      {"pose_unit", "the poses are in millimetres", "divide the translations by 1000", longer(1e-3)},
      {"pose_unit", "the poses are in metres where millimetres are expected", "multiply the translations by 1000",
       longer(1e3)},
      {"depth_scale", "the depth is a tenth of what it says", "--depth-scale, a tenth of the present one", longer(10)},
      {"depth_scale", "the depth is ten times what it says", "--depth-scale, ten times the present one", longer(0.1)},
      // Millimetres and the unit of TUM, 0.2 mm, are often confused.
      {"depth_scale", "the depth is a fifth of what it says", "--depth-scale, a fifth of the present one", longer(5)},
      {"depth_scale", "the depth is five times what it says", "--depth-scale, five times the present one",
       longer(0.2)}};
}

void check_poses(const RgbdFrame& a, const RgbdFrame& b, int view, std::vector<Finding>& findings) {
  const Rigid3& from_a = a.world_from_camera;
  const Rigid3& from_b = b.world_from_camera;
  const double given = agreeing_share(a, b, from_b.inverse() * from_a);
  if (given > kGoodShare) return;
  const std::vector<Reading> readings = other_readings(from_a, from_b);
  std::vector<double> shares;
  for (const Reading& reading : readings) shares.push_back(agreeing_share(a, b, reading.b_from_a));
  const auto best = std::ranges::max_element(shares);
  if (*best < kMinOtherShare || (given > kMaxGivenShare && 1 - *best > kMaxRest * (1 - given))) return;
  const Reading& reading = readings[static_cast<std::size_t>(best - shares.begin())];
  findings.push_back(
      {.fault = reading.fault,
       .message = fmt::format("the depths of two views agree at {:.0f} % of the pixels, and at {:.0f} % if {}",
                              100 * given, 100 * *best, reading.condition),
       .remedy = reading.remedy,
       .value = *best,
       .unit = "",
       .threshold = kMinOtherShare,
       .margin = *best / kMinOtherShare,
       .view = view});
}

}  // namespace

bool PoseCheck::wants(const Rigid3& world_from_camera) const {
  return !is_done_ && first_ && (has_moved(world_from_camera) || may_have_moved(world_from_camera));
}

std::vector<Finding> PoseCheck::add(const RgbdFrame& frame, int view) {
  std::vector<Finding> findings;
  if (is_done_) return findings;
  if (!first_) {
    first_ = frame;
    depth_m_ = measure_depth_values(frame.depth_m).median_m;
    next_move_m_ = kMinMoveInMetres * depth_m_;
    return findings;
  }
  if (!wants(frame.world_from_camera)) return findings;
  check_poses(*first_, frame, view, findings);
  is_done_ = !findings.empty() || has_moved(frame.world_from_camera);
  ++num_near_views_;
  next_move_m_ = 2e3 * move_m(frame.world_from_camera);
  if (is_done_) first_.reset();
  return findings;
}

double PoseCheck::move_m(const Rigid3& pose) const {
  return (pose.translation - first_->world_from_camera.translation).norm();
}

bool PoseCheck::has_moved(const Rigid3& pose) const {
  return move_m(pose) > kMinMove * depth_m_ ||
         rotation_angle_rad(pose.rotation, first_->world_from_camera.rotation) > kMinMove_rad;
}

bool PoseCheck::may_have_moved(const Rigid3& pose) const {
  return num_near_views_ < kMaxNearViews && 1e3 * move_m(pose) >= next_move_m_;
}

std::vector<Finding> check_quickly(const Sequence& sequence, bool uses_poses) {
  std::vector<Finding> findings;
  const auto first = sequence.read_view(0);
  if (!first.ok()) return findings;
  const int num_views = sequence.num_views();
  for (const int v : std::set<int>{0, num_views / 2, num_views - 1}) {
    const auto view = v == 0 ? first : sequence.read_view(v);
    if (!view.ok()) continue;
    for (Finding& finding : find_view_faults(*view)) {
      if (std::ranges::find(findings, finding.fault, &Finding::fault) != findings.end()) continue;
      finding.view = v;
      if (v > 0) finding.message = fmt::format("view {}: {}", sequence.view_name(v), finding.message);
      findings.push_back(std::move(finding));
    }
  }
  const bool is_first_good = findings.empty() || findings.front().view > 0;
  if (!is_first_good || !uses_poses || !sequence.has_poses()) return findings;
  PoseCheck check;
  std::ignore = check.add(*first, 0);
  for (int v = 1; v < num_views && !check.is_done(); ++v) {
    const auto pose = sequence.read_pose(v);
    if (!pose.ok()) break;
    if (!check.wants(*pose)) continue;
    if (const auto view = sequence.read_view(v); view.ok())
      std::ranges::move(check.add(*view, v), std::back_inserter(findings));
  }
  return findings;
}

}  // namespace resight
