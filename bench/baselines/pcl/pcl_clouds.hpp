// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <pcl/point_cloud.h>
#include <pcl/point_types.h>

#include <cmath>
#include <vector>

#include "pcl_peers.hpp"

/// Converts between plain arrays and PCL's types.
namespace resight::bench::pcl_peers {

using XyzCloud = pcl::PointCloud<pcl::PointXYZ>;

inline XyzCloud::Ptr make_cloud(Points points) {
  XyzCloud::Ptr cloud(new XyzCloud);
  cloud->resize(points.size() / 3);
  cloud->is_dense = true;
  for (std::size_t i = 0; i < cloud->size(); ++i) {
    (*cloud)[i] = pcl::PointXYZ(points[3 * i], points[3 * i + 1], points[3 * i + 2]);
    if (!std::isfinite(points[3 * i + 2])) cloud->is_dense = false;
  }
  return cloud;
}

inline XyzCloud::Ptr make_cloud(const OrganizedPoints& view) {
  XyzCloud::Ptr cloud = make_cloud(view.xyz);
  cloud->width = static_cast<std::uint32_t>(view.width);
  cloud->height = static_cast<std::uint32_t>(view.height);
  return cloud;
}

inline pcl::PointCloud<pcl::Normal>::Ptr make_normals(Points normals) {
  pcl::PointCloud<pcl::Normal>::Ptr cloud(new pcl::PointCloud<pcl::Normal>);
  cloud->resize(normals.size() / 3);
  for (std::size_t i = 0; i < cloud->size(); ++i)
    (*cloud)[i] = pcl::Normal(normals[3 * i], normals[3 * i + 1], normals[3 * i + 2]);
  return cloud;
}

inline std::vector<float> to_floats(const XyzCloud& cloud) {
  std::vector<float> result;
  result.reserve(3 * cloud.size());
  for (const pcl::PointXYZ& p : cloud) result.insert(result.end(), {p.x, p.y, p.z});
  return result;
}

inline std::vector<float> to_floats(const pcl::PointCloud<pcl::Normal>& cloud) {
  std::vector<float> result;
  result.reserve(3 * cloud.size());
  for (const pcl::Normal& n : cloud) result.insert(result.end(), {n.normal_x, n.normal_y, n.normal_z});
  return result;
}

inline Eigen::Matrix4f to_matrix(const Pose& pose) {
  Eigen::Matrix4f matrix = Eigen::Matrix4f::Identity();
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 4; ++column) matrix(row, column) = pose[static_cast<std::size_t>(4 * row + column)];
  return matrix;
}

inline Pose to_pose(const Eigen::Matrix4f& matrix) {
  Pose pose;
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 4; ++column) pose[static_cast<std::size_t>(4 * row + column)] = matrix(row, column);
  return pose;
}

}  // namespace resight::bench::pcl_peers
