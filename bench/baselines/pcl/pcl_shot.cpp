// SPDX-License-Identifier: Apache-2.0
#include <pcl/features/shot_omp.h>
#include <pcl/kdtree/kdtree_flann.h>

#include <algorithm>

#include "../cpu_clock.hpp"
#include "pcl_clouds.hpp"

namespace resight::bench::pcl_peers {
namespace {

constexpr std::size_t kDimension = 352;
using ShotCloud = pcl::PointCloud<pcl::SHOT352>;

ShotCloud::Ptr make_shot_cloud(std::span<const float> descriptors) {
  ShotCloud::Ptr cloud(new ShotCloud);
  cloud->resize(descriptors.size() / kDimension);
  for (std::size_t i = 0; i < cloud->size(); ++i)
    std::copy_n(descriptors.begin() + static_cast<std::ptrdiff_t>(i * kDimension), kDimension, (*cloud)[i].descriptor);
  return cloud;
}

}  // namespace

Timed<std::vector<float>> describe_shot(Points keypoints, OrientedPoints support, float radius_m) {
  const XyzCloud::Ptr points = make_cloud(keypoints);
  const XyzCloud::Ptr surface = make_cloud(support.xyz);
  const auto normals = make_normals(support.normals);
  ShotCloud descriptors;
  const CpuClock clock;
  pcl::SHOTEstimationOMP<pcl::PointXYZ, pcl::Normal, pcl::SHOT352> estimation(1);
  estimation.setInputCloud(points);
  estimation.setSearchSurface(surface);
  estimation.setInputNormals(normals);
  estimation.setRadiusSearch(radius_m);
  estimation.compute(descriptors);
  const double cpu_s = clock.elapsed_s();
  std::vector<float> result;
  result.reserve(descriptors.size() * kDimension);
  for (const pcl::SHOT352& d : descriptors) result.insert(result.end(), d.descriptor, d.descriptor + kDimension);
  return {std::move(result), cpu_s};
}

Timed<std::vector<int>> nearest_shot(std::span<const float> indexed, std::span<const float> queries) {
  const ShotCloud::Ptr set = make_shot_cloud(indexed);
  const ShotCloud::Ptr wanted = make_shot_cloud(queries);
  pcl::KdTreeFLANN<pcl::SHOT352> tree;
  tree.setInputCloud(set);
  std::vector<int> nearest;
  pcl::Indices index(1);
  std::vector<float> distance_sq(1);
  const CpuClock clock;
  for (const pcl::SHOT352& query : *wanted)
    nearest.push_back(tree.nearestKSearch(query, 1, index, distance_sq) == 1 ? index.front() : -1);
  const double cpu_s = clock.elapsed_s();
  return {std::move(nearest), cpu_s};
}

}  // namespace resight::bench::pcl_peers
