// SPDX-License-Identifier: Apache-2.0
#include <pcl/features/integral_image_normal.h>
#include <pcl/features/normal_3d_omp.h>
#include <pcl/search/kdtree.h>
#include <pcl/search/organized.h>

#include "../cpu_clock.hpp"
#include "pcl_clouds.hpp"

namespace resight::bench::pcl_peers {

Timed<std::vector<float>> normals_by_radius(OrganizedPoints view, float radius_m, NeighborSearch search) {
  const XyzCloud::Ptr cloud = make_cloud(view);
  pcl::PointCloud<pcl::Normal> normals;
  const CpuClock clock;
  pcl::NormalEstimationOMP<pcl::PointXYZ, pcl::Normal> estimation(1);
  estimation.setInputCloud(cloud);
  estimation.setRadiusSearch(radius_m);
  if (search == NeighborSearch::kKdTree)
    estimation.setSearchMethod(pcl::make_shared<pcl::search::KdTree<pcl::PointXYZ>>());
  else
    estimation.setSearchMethod(pcl::make_shared<pcl::search::OrganizedNeighbor<pcl::PointXYZ>>());
  estimation.compute(normals);
  const double cpu_s = clock.elapsed_s();
  return {to_floats(normals), cpu_s};
}

Timed<std::vector<float>> normals_by_integral_image(OrganizedPoints view, IntegralImageMethod method,
                                                    float max_depth_change, float window_px) {
  using Estimation = pcl::IntegralImageNormalEstimation<pcl::PointXYZ, pcl::Normal>;
  const XyzCloud::Ptr cloud = make_cloud(view);
  pcl::PointCloud<pcl::Normal> normals;
  const CpuClock clock;
  Estimation estimation;
  estimation.setNormalEstimationMethod(method == IntegralImageMethod::kCovariance ? Estimation::COVARIANCE_MATRIX
                                                                                  : Estimation::AVERAGE_3D_GRADIENT);
  estimation.setMaxDepthChangeFactor(max_depth_change);
  estimation.setNormalSmoothingSize(window_px);
  estimation.setInputCloud(cloud);
  estimation.compute(normals);
  const double cpu_s = clock.elapsed_s();
  return {to_floats(normals), cpu_s};
}

}  // namespace resight::bench::pcl_peers
