// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <span>
#include <vector>

#include "resight/core/image.hpp"
#include "resight/geometry/rigid3.hpp"

namespace resight {

/// An unorganised cloud in metres. All points are finite. `normals` (unit) and `colors` are empty or as long as
/// `points`.
struct PointCloud {
  std::vector<Eigen::Vector3f> points;
  std::vector<Eigen::Vector3f> normals;
  std::vector<Rgb8> colors;

  [[nodiscard]] std::size_t size() const { return points.size(); }
  [[nodiscard]] bool empty() const { return points.empty(); }
  [[nodiscard]] bool has_normals() const { return !points.empty() && normals.size() == points.size(); }
  [[nodiscard]] bool has_colors() const { return !points.empty() && colors.size() == points.size(); }
  /// Appends the points of `other`. Both clouds must have the same attributes unless this cloud is empty.
  void append(const PointCloud& other);
};

/// Transforms the cloud to frame a. Rotates normals and keeps colours.
[[nodiscard]] PointCloud transform(const Rigid3& a_from_b, const PointCloud& cloud_in_b);

/// The points with the given indices, in that order, with their attributes.
[[nodiscard]] PointCloud select(const PointCloud& cloud, std::span<const int> indices);

/// Whether no two points share a cube of side `voxel_size_m`. voxel_downsample() would then average nothing.
[[nodiscard]] bool is_downsampled(const PointCloud& cloud, double voxel_size_m);

/// One point per occupied cube of side `voxel_size_m`: the means of its points, normals (renormalised) and colours.
/// Voxels are in order of their first points.
[[nodiscard]] PointCloud voxel_downsample(const PointCloud& cloud, double voxel_size_m);

/// Mean of the points; zero for an empty cloud.
[[nodiscard]] Eigen::Vector3f centroid(std::span<const Eigen::Vector3f> points);

}  // namespace resight
