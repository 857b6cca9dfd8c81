// SPDX-License-Identifier: Apache-2.0
#include <pcl/recognition/cg/geometric_consistency.h>

#include "../cpu_clock.hpp"
#include "pcl_clouds.hpp"

namespace resight::bench::pcl_peers {

Timed<std::vector<Pose>> group_correspondences(Points model_xyz, Points scene_xyz, std::span<const float> distances,
                                               float consistency_m, int min_group_size) {
  const XyzCloud::Ptr model = make_cloud(model_xyz);
  const XyzCloud::Ptr scene = make_cloud(scene_xyz);
  pcl::CorrespondencesPtr pairs(new pcl::Correspondences);
  for (std::size_t i = 0; i < distances.size(); ++i)
    pairs->emplace_back(static_cast<int>(i), static_cast<int>(i), distances[i]);
  std::vector<Eigen::Matrix4f, Eigen::aligned_allocator<Eigen::Matrix4f>> found;
  const CpuClock clock;
  pcl::GeometricConsistencyGrouping<pcl::PointXYZ, pcl::PointXYZ> grouping;
  grouping.setGCSize(consistency_m);
  grouping.setGCThreshold(min_group_size - 1);  // PCL requires more than this number.
  grouping.setInputCloud(model);
  grouping.setSceneCloud(scene);
  grouping.setModelSceneCorrespondences(pairs);
  grouping.recognize(found);
  const double cpu_s = clock.elapsed_s();
  std::vector<Pose> poses;
  for (const Eigen::Matrix4f& scene_from_object : found) poses.push_back(to_pose(scene_from_object));
  return {std::move(poses), cpu_s};
}

}  // namespace resight::bench::pcl_peers
