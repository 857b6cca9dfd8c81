// SPDX-License-Identifier: Apache-2.0
#include <pcl/octree/octree_pointcloud_changedetector.h>
#include <pcl/search/kdtree.h>
#include <pcl/segmentation/segment_differences.h>

#include "../cpu_clock.hpp"
#include "pcl_clouds.hpp"

namespace resight::bench::pcl_peers {
namespace {

using LabelledCloud = pcl::PointCloud<pcl::PointXYZL>;

// Points are labelled with their index, because PCL returns the difference as points.
LabelledCloud::Ptr make_labelled_cloud(Points points) {
  LabelledCloud::Ptr cloud(new LabelledCloud);
  cloud->resize(points.size() / 3);
  for (std::size_t i = 0; i < cloud->size(); ++i)
    (*cloud)[i] = pcl::PointXYZL(points[3 * i], points[3 * i + 1], points[3 * i + 2], static_cast<std::uint32_t>(i));
  return cloud;
}

}  // namespace

Timed<std::vector<int>> point_cloud_difference(Points a, Points b, float tolerance_m) {
  const LabelledCloud::Ptr source = make_labelled_cloud(a);
  const LabelledCloud::Ptr target = make_labelled_cloud(b);
  LabelledCloud difference;
  const CpuClock clock;
  const pcl::search::Search<pcl::PointXYZL>::Ptr tree(new pcl::search::KdTree<pcl::PointXYZL>(false));
  tree->setInputCloud(target);
  // PCL compares squared distances with its threshold.
  pcl::getPointCloudDifference<pcl::PointXYZL>(*source, static_cast<double>(tolerance_m) * tolerance_m, tree,
                                               difference);
  const double cpu_s = clock.elapsed_s();
  std::vector<int> indices;
  for (const pcl::PointXYZL& p : difference) indices.push_back(static_cast<int>(p.label));
  return {std::move(indices), cpu_s};
}

Timed<std::vector<int>> octree_difference(Points a, Points b, float voxel_m) {
  const XyzCloud::Ptr source = make_cloud(a);
  const XyzCloud::Ptr target = make_cloud(b);
  pcl::Indices indices;
  const CpuClock clock;
  pcl::octree::OctreePointCloudChangeDetector<pcl::PointXYZ> octree(voxel_m);
  octree.setInputCloud(target);
  octree.addPointsFromInputCloud();
  octree.switchBuffers();
  octree.setInputCloud(source);
  octree.addPointsFromInputCloud();
  octree.getPointIndicesFromNewVoxels(indices);
  const double cpu_s = clock.elapsed_s();
  return {std::vector<int>(indices.begin(), indices.end()), cpu_s};
}

}  // namespace resight::bench::pcl_peers
