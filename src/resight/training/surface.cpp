// SPDX-License-Identifier: Apache-2.0
#include "resight/training/surface.hpp"

#include <cmath>

#include "resight/core/check.hpp"
#include "resight/geometry/voxel_map.hpp"

namespace resight {
namespace {

constexpr float kOtherSideCosine = -0.5F;

struct WeightedMean {
  Eigen::Vector3d point = Eigen::Vector3d::Zero();
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();
  Eigen::Vector3d color = Eigen::Vector3d::Zero();
  double weight = 0;
  std::size_t first = 0;

  void add(const PointCloud& cloud, std::size_t i, double w) {
    if (weight == 0) first = i;
    point += w * cloud.points[i].cast<double>();
    normal += w * cloud.normals[i].cast<double>();
    color += w * Eigen::Vector3d(cloud.colors[i].r, cloud.colors[i].g, cloud.colors[i].b);
    weight += w;
  }
};

void append_mean(PointCloud& cloud, const WeightedMean& mean, const PointCloud& samples) {
  cloud.points.push_back((mean.point / mean.weight).cast<float>());
  const bool cancelled = mean.normal.norm() < 1e-3 * mean.weight;
  cloud.normals.push_back(cancelled ? samples.normals[mean.first]
                                    : Eigen::Vector3f(mean.normal.normalized().cast<float>()));
  const Eigen::Vector3d c = mean.color / mean.weight;
  const auto round = [](double x) { return static_cast<std::uint8_t>(x + 0.5); };
  cloud.colors.push_back({round(c.x()), round(c.y()), round(c.z())});
}

// Index of the most certain sample of each cube. Cubes are in order of their first samples.
std::vector<std::size_t> find_best_samples(const SurfaceSamples& samples, VoxelMap& cubes, float inverse_size) {
  std::vector<std::size_t> best;
  for (std::size_t i = 0; i < samples.cloud.size(); ++i) {
    const auto cube = static_cast<std::size_t>(cubes.insert(voxel_key(samples.cloud.points[i], inverse_size)));
    if (cube == best.size())
      best.push_back(i);
    else if (samples.sigma_m[i] < samples.sigma_m[best[cube]])
      best[cube] = i;
  }
  return best;
}

}  // namespace

SurfaceSamples collect_surface_samples(const PreparedView& view, const Image<std::uint8_t>& mask,
                                       double min_edge_distance_px) {
  const OrganizedCloud& cloud = view.cloud;
  const Rigid3f object_from_camera(view.frame.world_from_camera);
  SurfaceSamples samples;
  for (std::size_t i = 0; i < mask.size(); ++i) {
    if (mask[i] == 0 || !cloud.has_point(i) || !cloud.has_normal(i)) continue;
    if (!(view.edge_distance_px[i] > min_edge_distance_px)) continue;
    samples.cloud.points.push_back(object_from_camera * cloud.point(i));
    samples.cloud.normals.push_back(object_from_camera.rotation * cloud.normal(i));
    samples.cloud.colors.push_back(view.frame.color[i]);
    samples.sigma_m.push_back(std::hypot(view.noise.lateral_m[i], view.noise.axial_m[i]));
  }
  return samples;
}

PointCloud fuse_surface(const SurfaceSamples& samples, double voxel_size_m) {
  check_positive("voxel_size_m", voxel_size_m);
  require(samples.sigma_m.size() == samples.cloud.size(), "fuse_surface: one sigma is needed for each point");
  require(samples.cloud.empty() || (samples.cloud.has_normals() && samples.cloud.has_colors()),
          "fuse_surface: the points need normals and colours");
  const auto inverse_size = static_cast<float>(1.0 / voxel_size_m);
  VoxelMap cubes(samples.cloud.size() / 4);
  const std::vector<std::size_t> best = find_best_samples(samples, cubes, inverse_size);
  std::vector<WeightedMean> front(best.size());
  std::vector<WeightedMean> back(best.size());
  for (std::size_t i = 0; i < samples.cloud.size(); ++i) {
    const auto cube = static_cast<std::size_t>(cubes.find(voxel_key(samples.cloud.points[i], inverse_size)));
    const bool faces_away = samples.cloud.normals[i].dot(samples.cloud.normals[best[cube]]) < kOtherSideCosine;
    const double sigma = samples.sigma_m[i];
    (faces_away ? back : front)[cube].add(samples.cloud, i, 1.0 / (sigma * sigma));
  }
  PointCloud fused;
  for (std::size_t cube = 0; cube < best.size(); ++cube) {
    append_mean(fused, front[cube], samples.cloud);
    if (back[cube].weight > 0) append_mean(fused, back[cube], samples.cloud);
  }
  return fused;
}

}  // namespace resight
