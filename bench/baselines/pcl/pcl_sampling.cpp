// SPDX-License-Identifier: Apache-2.0
#include <pcl/filters/uniform_sampling.h>
#include <pcl/filters/voxel_grid.h>

#include "../cpu_clock.hpp"
#include "pcl_clouds.hpp"

namespace resight::bench::pcl_peers {

Timed<std::vector<float>> voxel_grid(Points points, float leaf_m) {
  const XyzCloud::Ptr cloud = make_cloud(points);
  XyzCloud downsampled;
  const CpuClock clock;
  pcl::VoxelGrid<pcl::PointXYZ> grid;
  grid.setInputCloud(cloud);
  grid.setLeafSize(leaf_m, leaf_m, leaf_m);
  grid.filter(downsampled);
  const double cpu_s = clock.elapsed_s();
  return {to_floats(downsampled), cpu_s};
}

Timed<std::vector<float>> uniform_sampling(Points points, float spacing_m) {
  const XyzCloud::Ptr cloud = make_cloud(points);
  XyzCloud sampled;
  const CpuClock clock;
  pcl::UniformSampling<pcl::PointXYZ> sampling;
  sampling.setInputCloud(cloud);
  sampling.setRadiusSearch(spacing_m);
  sampling.filter(sampled);
  const double cpu_s = clock.elapsed_s();
  return {to_floats(sampled), cpu_s};
}

}  // namespace resight::bench::pcl_peers
