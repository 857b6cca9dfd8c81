// SPDX-License-Identifier: Apache-2.0
// SHOT descriptors of the same keypoints on the same surface.
#include "resight/features/shot.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "contest.hpp"
#include "plain_points.hpp"
#include "resight/features/descriptor_index.hpp"
#include "resight/geometry/kd_tree.hpp"
#include "stages.hpp"

namespace resight::bench {
namespace {

constexpr int kDimension = 352;
// A keypoint of the other view this near, in the world frame, is the same one.
constexpr double kPartner_m = 0.01;
constexpr double kRight_m = 0.02;  // A match within this distance is right.

/// What is described in a view.
struct ShotTask {
  PointCloud support, keypoints;  // Camera frame.
  Rigid3 world_from_camera;
};

// Keypoints of the view as it is, and its surface with normals from windows of this radius.
ShotTask make_task(const PreparedView& view, const ShotOptions& options, int normals_radius_px) {
  const FeatureSet features = extract_shot(view, options);
  OrganizedCloud cloud = view.cloud;
  compute_normals(cloud, {.window_radius_px = normals_radius_px});
  ShotTask task;
  task.support = voxel_downsample(to_point_cloud(cloud, nullptr, true), *options.support_voxel_m);
  task.keypoints.points = features.points;
  task.keypoints.normals = features.normals;
  task.world_from_camera = view.frame.world_from_camera;
  return task;
}

/// Keypoints with descriptors, world frame.
struct Described {
  std::vector<Eigen::Vector3f> points_in_world;
  std::vector<float> descriptors;
  double cpu_s = 0;
};

Described describe_ours(const ShotTask& task, const ShotOptions& options) {
  Described result;
  FeatureSet features;
  result.cpu_s = cpu_time_s([&] { features = describe_shot(task.support, task.keypoints, options); });
  const FeatureSet in_world = transform(task.world_from_camera, std::move(features));
  result.points_in_world = in_world.points;
  result.descriptors = in_world.descriptors;
  return result;
}

Described describe_peer(const ShotTask& task, const ShotOptions& options) {
  const auto all = pcl_peers::describe_shot(to_plain(task.keypoints.points),
                                            {to_plain(task.support.points), to_plain(task.support.normals)},
                                            static_cast<float>(options.support_radius_m));
  const Rigid3f world_from_camera(task.world_from_camera);
  Described result;
  result.cpu_s = all.cpu_s;
  for (std::size_t i = 0; i < task.keypoints.size(); ++i) {
    const auto row = std::span(all.value).subspan(i * kDimension, kDimension);
    if (!std::ranges::all_of(row, [](float x) { return std::isfinite(x); })) continue;
    result.points_in_world.push_back(world_from_camera * task.keypoints.points[i]);
    result.descriptors.insert(result.descriptors.end(), row.begin(), row.end());
  }
  return result;
}

std::string rate(const Described& view, const Described& before, std::size_t num_keypoints) {
  const DescriptorIndex exact(before.descriptors, kDimension, {.search = IndexSearch::kExact});
  const std::vector<DescriptorMatch> matches = exact.search(view.descriptors, 1);
  const KdTree tree(before.points_in_world);
  int num_with_partner = 0, num_right = 0;
  for (std::size_t i = 0; i < matches.size(); ++i) {
    const Eigen::Vector3f& p = view.points_in_world[i];
    if (tree.nearest(p).distance_sq > kPartner_m * kPartner_m) continue;
    ++num_with_partner;
    const auto match = static_cast<std::size_t>(matches[i].index);
    num_right += (before.points_in_world[match] - p).norm() < kRight_m ? 1 : 0;
  }
  return fmt::format("{} of {} keypoints described; {:.1f} % of {} matched rightly in the other view",
                     view.points_in_world.size(), num_keypoints, 100.0 * num_right / std::max(1, num_with_partner),
                     num_with_partner);
}

}  // namespace

void compare_shot(const StageInput& input) {
  ShotOptions options = input.config.features.shot;
  const int radius_px = input.config.prepare.normals.window_radius_px;
  const ShotTask task = make_task(input.view, options, radius_px);
  const ShotTask before = make_task(input.before, options, radius_px);
  const ShotTask smooth_task = make_task(input.view, options, 2 * radius_px);
  const ShotTask smooth_before = make_task(input.before, options, 2 * radius_px);
  const std::size_t num_keypoints = task.keypoints.size();
  options.min_surface_variation = 0;  // Flat keypoints have been removed already.
  Described ours, smooth, peer;
  compare(fmt::format("SHOT, {:.0f} cm", 1e2 * options.support_radius_m),
          {{"resight", [&] { return (ours = describe_ours(task, options)).cpu_s; },
            [&] { return rate(ours, describe_ours(before, options), num_keypoints); }},
           {"PCL SHOTEstimationOMP", [&] { return (peer = describe_peer(task, options)).cpu_s; },
            [&] { return rate(peer, describe_peer(before, options), num_keypoints); }},
           {fmt::format("resight, normals of {0} x {0} px", 4 * radius_px + 1),
            [&] { return (smooth = describe_ours(smooth_task, options)).cpu_s; },
            [&] { return rate(smooth, describe_ours(smooth_before, options), num_keypoints); }}});
}

}  // namespace resight::bench
