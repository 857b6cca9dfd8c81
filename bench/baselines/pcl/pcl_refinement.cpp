// SPDX-License-Identifier: Apache-2.0
#include <pcl/registration/icp.h>

#include "../cpu_clock.hpp"
#include "pcl_clouds.hpp"

namespace resight::bench::pcl_peers {
namespace {

using PointNormalCloud = pcl::PointCloud<pcl::PointNormal>;
using Tree = pcl::search::KdTree<pcl::PointNormal>;

PointNormalCloud::Ptr make_oriented_cloud(Points xyz, Points normals) {
  PointNormalCloud::Ptr cloud(new PointNormalCloud);
  cloud->resize(xyz.size() / 3);
  for (std::size_t i = 0; i < cloud->size(); ++i)
    (*cloud)[i] = pcl::PointNormal(xyz[3 * i], xyz[3 * i + 1], xyz[3 * i + 2], normals[3 * i], normals[3 * i + 1],
                                   normals[3 * i + 2]);
  return cloud;
}

template <typename Icp>
Timed<std::vector<Pose>> refine(const PointNormalCloud::Ptr& scene, std::span<const RefinementTask> tasks,
                                float max_distance_m, int max_iterations) {
  const Tree::Ptr tree(new Tree);
  tree->setInputCloud(scene);
  Timed<std::vector<Pose>> result;
  for (const RefinementTask& task : tasks) {
    const PointNormalCloud::Ptr object = make_oriented_cloud(task.xyz, task.normals);
    const Eigen::Matrix4f start = to_matrix(task.start);
    PointNormalCloud moved;
    const CpuClock clock;
    Icp icp;
    icp.setSearchMethodTarget(tree, true);
    icp.setInputSource(object);
    icp.setInputTarget(scene);
    icp.setMaxCorrespondenceDistance(max_distance_m);
    icp.setMaximumIterations(max_iterations);
    icp.align(moved, start);
    result.cpu_s += clock.elapsed_s();
    result.value.push_back(to_pose(icp.getFinalTransformation()));
  }
  return result;
}

}  // namespace

Timed<std::vector<Pose>> refine_poses(OrientedPoints scene, std::span<const RefinementTask> tasks, IcpKind kind,
                                      float max_distance_m, int max_iterations) {
  using PointToPoint = pcl::IterativeClosestPoint<pcl::PointNormal, pcl::PointNormal>;
  using PointToPlane = pcl::IterativeClosestPointWithNormals<pcl::PointNormal, pcl::PointNormal>;
  const PointNormalCloud::Ptr cloud = make_oriented_cloud(scene.xyz, scene.normals);
  return kind == IcpKind::kPointToPoint ? refine<PointToPoint>(cloud, tasks, max_distance_m, max_iterations)
                                        : refine<PointToPlane>(cloud, tasks, max_distance_m, max_iterations);
}

}  // namespace resight::bench::pcl_peers
