// SPDX-License-Identifier: Apache-2.0
// A view downsampled to 5 mm, and keypoints 1 cm apart from it.
#include <fmt/format.h>

#include "contest.hpp"
#include "plain_points.hpp"
#include "resight/features/uniform_sampling.hpp"
#include "resight/geometry/voxel_key.hpp"
#include "stages.hpp"

namespace resight::bench {
namespace {

using Points = std::vector<Eigen::Vector3f>;

double mean_distance_to_center_m(const Points& points, double spacing_m) {
  double sum_m = 0;
  for (const Eigen::Vector3f& p : points) {
    const Eigen::Vector3i cube = voxel_index(p, static_cast<float>(1.0 / spacing_m));
    sum_m += (p.cast<double>() - (cube.cast<double>().array() + 0.5).matrix() * spacing_m).norm();
  }
  return sum_m / static_cast<double>(points.size());
}

void compare_thinning(const PointCloud& cloud, double voxel_m) {
  PointCloud ours;
  std::vector<float> peer;
  compare(fmt::format("thinning, {:.0f} mm", 1e3 * voxel_m),
          {{"resight", [&] { return cpu_time_s([&] { ours = voxel_downsample(cloud, voxel_m); }); },
            [&] { return fmt::format("{} points of {}", ours.size(), cloud.size()); }},
           {"PCL VoxelGrid",
            [&] {
              auto result = pcl_peers::voxel_grid(to_plain(cloud.points), static_cast<float>(voxel_m));
              peer = std::move(result.value);
              return result.cpu_s;
            },
            [&] { return fmt::format("{} points", peer.size() / 3); }}});
}

std::string describe(const Points& keypoints, double spacing_m) {
  return fmt::format("{} keypoints, on average {:.2f} mm from the centres of their cubes", keypoints.size(),
                     1e3 * mean_distance_to_center_m(keypoints, spacing_m));
}

void compare_keypoints(const Points& surface, double spacing_m) {
  std::vector<int> ours;
  Points peer;
  compare(fmt::format("keypoints, {:.0f} mm", 1e3 * spacing_m),
          {{"resight", [&] { return cpu_time_s([&] { ours = sample_uniformly(surface, spacing_m); }); },
            [&] {
              Points sampled;
              for (const int i : ours) sampled.push_back(surface[static_cast<std::size_t>(i)]);
              return describe(sampled, spacing_m);
            }},
           {"PCL UniformSampling",
            [&] {
              const auto result = pcl_peers::uniform_sampling(to_plain(surface), static_cast<float>(spacing_m));
              peer = from_plain(result.value);
              return result.cpu_s;
            },
            [&] { return describe(peer, spacing_m); }}});
}

}  // namespace

void compare_sampling(const StageInput& input) {
  PointCloud cloud;
  cloud.points = to_point_cloud(input.view.cloud, nullptr, false).points;
  compare_thinning(cloud, *input.config.features.shot.support_voxel_m);
  compare_keypoints(voxel_downsample(cloud, *input.config.features.shot.support_voxel_m).points,
                    input.config.features.shot.keypoint_spacing_m);
}

}  // namespace resight::bench
