// SPDX-License-Identifier: Apache-2.0
#include "resight/annotation/place_by_click.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>

#include "resight/annotation/internal/color_difference.hpp"
#include "resight/annotation/internal/sampled_surface.hpp"
#include "resight/annotation/internal/support_plane.hpp"
#include "resight/annotation/refine_over_views.hpp"
#include "resight/evidence/surface_evidence.hpp"

namespace resight {
namespace {

constexpr int kNumTurns = 24;
constexpr int kCoarsePoints = 250;
constexpr int kFinePoints = 1200;
constexpr std::size_t kNumRefined = 30;
constexpr double kOnPlane_m = 0.012;
constexpr std::array<double, 4> kShifts{0.0, 0.1, 0.2, 0.35};  // Behind the click, in diameters.

/// A pose and how well the view supports it; larger is better.
struct ScoredPose {
  Rigid3 camera_from_object;
  double score = -std::numeric_limits<double>::infinity();
};

/// Of the points that face the camera: present ones count for the pose, those seen through against it, and so do wrong
/// colours.
double score_pose(const SampledSurface& surface, const Rigid3& camera_from_object, const RgbdFrame& frame,
                  double margin_m) {
  SurfaceEvidenceOptions options;
  options.margin = {.base_m = margin_m, .noise_sigmas = 3};
  options.self_occlusion_spacing_m = surface.spacing_m;
  const SurfaceEvidence evidence = classify_surface({surface.cloud.points, surface.cloud.normals}, camera_from_object,
                                                    {frame.camera, frame.depth_m}, options);
  const double num_present = evidence.num(Evidence::kPresent);
  const double num_seen_through = evidence.num(Evidence::kSeenThrough);
  const double num_occluded = evidence.num(Evidence::kOccluded);
  const double color =
      color_difference(surface, evidence, camera_from_object, frame).value_or(surface.cloud.has_colors() ? 1.0 : 0.0);
  const double facing = std::max(1.0, num_present + num_seen_through + 0.5 * num_occluded);
  // The second term prefers the pose that explains more of the view: a narrow side fits into a wide one.
  const double explained = num_present * (1 - 2 * std::min(0.5, color));
  return (explained - num_seen_through) / facing + explained / static_cast<double>(surface.cloud.size());
}

/// A rotation that maps the axis of the object onto the normal, turned about it.
Eigen::Matrix3d turn_onto(const Eigen::Vector3d& axis, const Eigen::Vector3d& normal, double angle_rad) {
  return Eigen::AngleAxisd(angle_rad, normal).toRotationMatrix() *
         Eigen::Quaterniond::FromTwoVectors(axis, normal).toRotationMatrix();
}

/// The pose with this rotation whose surface rests on the plane, its middle beside the click.
Rigid3 rest_on_plane(const SampledSurface& surface, const Eigen::Matrix3d& rotation, const SupportPlane& plane,
                     const Eigen::Vector3d& middle_in_camera) {
  double lowest = std::numeric_limits<double>::infinity();
  for (const Eigen::Vector3f& p : surface.cloud.points)
    lowest = std::min(lowest, plane.normal.dot(rotation * (p.cast<double>() - surface.middle)));
  const Eigen::Vector3d foot = middle_in_camera - plane.normal * plane.signed_distance_m(middle_in_camera);
  return {rotation, foot - lowest * plane.normal - rotation * surface.middle};
}

std::vector<ScoredPose> score_all(const ObjectModel& model, double surface_voxel_m, const RgbdFrame& frame,
                                  const SupportPlane& plane, const Eigen::Vector3d& clicked) {
  const SampledSurface surface = sample_surface_evenly(model, surface_voxel_m, kCoarsePoints);
  // What has been clicked on stands before the middle of the object.
  Eigen::Vector3d away = clicked - plane.normal * plane.normal.dot(clicked);
  away.normalize();
  const bool is_on_plane = std::abs(plane.signed_distance_m(clicked)) < kOnPlane_m;
  std::vector<ScoredPose> poses;
  for (int axis = 0; axis < 6; ++axis) {
    const Eigen::Vector3d up = Eigen::Vector3d::Unit((axis / 2 + 2) % 3) * (axis % 2 == 0 ? 1 : -1);  // +z first
    for (int turn = 0; turn < kNumTurns; ++turn) {
      const Eigen::Matrix3d rotation = turn_onto(up, plane.normal, turn * 2 * std::numbers::pi / kNumTurns);
      ScoredPose best;  // one per rotation, so that many are tried
      for (const double shift : kShifts) {
        if (is_on_plane && shift > 0) continue;
        ScoredPose pose;
        pose.camera_from_object =
            rest_on_plane(surface, rotation, plane, clicked + shift * 2 * surface.radius_m * away);
        pose.score = score_pose(surface, pose.camera_from_object, frame, 0.02) - 1e-3 * axis;  // upright wins ties
        if (pose.score > best.score) best = pose;
      }
      poses.push_back(best);
    }
  }
  std::ranges::stable_sort(poses, std::greater(), &ScoredPose::score);
  return poses;
}

}  // namespace

std::optional<Rigid3> place_by_click(const ObjectModel& model, double surface_voxel_m, const RgbdFrame& frame,
                                     Pixel pixel) {
  require(frame.depth_m.contains(pixel.u, pixel.v), "place_by_click: the pixel is outside the image");
  const auto clicked = find_clicked_point(frame, pixel);
  if (!clicked) return std::nullopt;
  const SupportPlane plane = find_support_plane(frame, *clicked, 1.5 * static_cast<double>(model.diameter_m));
  std::vector<ScoredPose> poses = score_all(model, surface_voxel_m, frame, plane, *clicked);
  const SampledSurface surface = sample_surface_evenly(model, surface_voxel_m, kFinePoints);
  RgbdFrame in_camera = frame;  // one view: its own frame is the world
  in_camera.world_from_camera = Rigid3::identity();
  const NumberedView view{0, &in_camera};
  ScoredPose best = poses.front();
  best.score = score_pose(surface, best.camera_from_object, frame, 0.008);
  for (std::size_t i = 0; i < std::min(kNumRefined, poses.size()); ++i) {
    RefineOverViewsOptions options;
    options.max_points = kFinePoints;
    options.max_iterations = 20;
    options.fit_twice = false;
    const auto refined =
        refine_over_views(model, surface_voxel_m, poses[i].camera_from_object, std::span(&view, 1), options);
    const double score = score_pose(surface, refined.world_from_object, frame, 0.008);
    if (score > best.score) best = {refined.world_from_object, score};
  }
  return frame.world_from_camera * best.camera_from_object;
}

}  // namespace resight
