// SPDX-License-Identifier: Apache-2.0
#include "resight/geometry/point_cloud.hpp"

#include "resight/core/check.hpp"
#include "resight/geometry/voxel_map.hpp"

namespace resight {

void PointCloud::append(const PointCloud& other) {
  if (other.empty()) return;
  if (&other == this) return append(PointCloud(other));  // insert() must not read from the vector that it grows
  require(empty() || (has_normals() == other.has_normals() && has_colors() == other.has_colors()),
          "PointCloud::append: the clouds have different attributes");
  points.insert(points.end(), other.points.begin(), other.points.end());
  normals.insert(normals.end(), other.normals.begin(), other.normals.end());
  colors.insert(colors.end(), other.colors.begin(), other.colors.end());
}

PointCloud transform(const Rigid3& a_from_b, const PointCloud& cloud_in_b) {
  const Rigid3f motion(a_from_b);
  PointCloud result;
  result.points.reserve(cloud_in_b.size());
  result.normals.reserve(cloud_in_b.normals.size());
  for (const Eigen::Vector3f& p : cloud_in_b.points) result.points.push_back(motion * p);
  for (const Eigen::Vector3f& n : cloud_in_b.normals) result.normals.push_back(motion.rotation * n);
  result.colors = cloud_in_b.colors;
  return result;
}

PointCloud select(const PointCloud& cloud, std::span<const int> indices) {
  PointCloud result;
  result.points.reserve(indices.size());
  for (const int i : indices) result.points.push_back(cloud.points[i]);
  if (cloud.has_normals())
    for (const int i : indices) result.normals.push_back(cloud.normals[i]);
  if (cloud.has_colors())
    for (const int i : indices) result.colors.push_back(cloud.colors[i]);
  return result;
}

bool is_downsampled(const PointCloud& cloud, double voxel_size_m) {
  const auto inverse_size = static_cast<float>(1.0 / voxel_size_m);
  VoxelMap voxels(cloud.size());
  for (std::size_t i = 0; i < cloud.size(); ++i)
    if (voxels.insert(voxel_key(cloud.points[i], inverse_size)) != static_cast<int>(i)) return false;
  return true;
}

PointCloud voxel_downsample(const PointCloud& cloud, double voxel_size_m) {
  check_positive("voxel_size_m", voxel_size_m);
  const float inverse_size = static_cast<float>(1.0 / voxel_size_m);
  struct Sums {
    Eigen::Vector3d point = Eigen::Vector3d::Zero();
    Eigen::Vector3d normal = Eigen::Vector3d::Zero();
    Eigen::Vector3d color = Eigen::Vector3d::Zero();
    std::size_t first = 0;
    int count = 0;
  };
  VoxelMap voxels(cloud.size() / 4);
  std::vector<Sums> sums;
  std::uint64_t last_key = 0;
  std::size_t number = 0;  // adjacent pixels mostly share a voxel, which saves the look-up
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const std::uint64_t key = voxel_key(cloud.points[i], inverse_size);
    if (i == 0 || key != last_key) number = static_cast<std::size_t>(voxels.insert(key));
    last_key = key;
    if (number == sums.size()) sums.emplace_back().first = i;
    Sums& s = sums[number];
    s.point += cloud.points[i].cast<double>();
    if (cloud.has_normals()) s.normal += cloud.normals[i].cast<double>();
    if (cloud.has_colors()) s.color += Eigen::Vector3d(cloud.colors[i].r, cloud.colors[i].g, cloud.colors[i].b);
    ++s.count;
  }
  PointCloud result;
  result.points.reserve(sums.size());
  for (const Sums& s : sums) {
    result.points.push_back((s.point / s.count).cast<float>());
    if (cloud.has_normals()) {
      // Opposite normals (both sides of a thin wall) cancel out. The first one is then used, so that the result is
      // always a unit vector.
      const bool cancelled = s.normal.norm() < 1e-3 * s.count;
      result.normals.push_back(cancelled ? cloud.normals[s.first]
                                         : Eigen::Vector3f(s.normal.normalized().cast<float>()));
    }
    if (cloud.has_colors()) {
      const Eigen::Vector3d c = s.color / s.count;
      const auto round = [](double x) { return static_cast<std::uint8_t>(x + 0.5); };
      result.colors.push_back({round(c.x()), round(c.y()), round(c.z())});
    }
  }
  return result;
}

Eigen::Vector3f centroid(std::span<const Eigen::Vector3f> points) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3f& p : points) sum += p.cast<double>();
  return points.empty() ? Eigen::Vector3f::Zero()
                        : Eigen::Vector3f((sum / static_cast<double>(points.size())).cast<float>());
}

}  // namespace resight
