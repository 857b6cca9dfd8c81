// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <span>
#include <vector>

#include "pcl/pcl_peers.hpp"
#include "resight/geometry/rigid3.hpp"
#include "resight/sensor/organized_cloud.hpp"

/// Converts between our types and the plain arrays of the peers.
namespace resight::bench {

inline std::span<const float> to_plain(std::span<const Eigen::Vector3f> points) {
  static_assert(sizeof(Eigen::Vector3f) == 3 * sizeof(float));
  return points.empty() ? std::span<const float>{} : std::span(points.front().data(), 3 * points.size());
}

inline std::vector<Eigen::Vector3f> from_plain(std::span<const float> xyz) {
  std::vector<Eigen::Vector3f> points;
  for (std::size_t i = 0; i + 2 < xyz.size(); i += 3) points.emplace_back(xyz[i], xyz[i + 1], xyz[i + 2]);
  return points;
}

/// All pixels, row by row.
inline std::vector<Eigen::Vector3f> points_of_pixels(const OrganizedCloud& cloud) {
  std::vector<Eigen::Vector3f> points;
  for (std::size_t i = 0; i < cloud.z.size(); ++i) points.push_back(cloud.point(i));
  return points;
}

inline pcl_peers::Pose to_plain(const Rigid3& a_from_b) {
  pcl_peers::Pose pose;
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column)
      pose[static_cast<std::size_t>(4 * row + column)] = static_cast<float>(a_from_b.rotation(row, column));
    pose[static_cast<std::size_t>(4 * row + 3)] = static_cast<float>(a_from_b.translation[row]);
  }
  return pose;
}

inline Rigid3 from_plain(const pcl_peers::Pose& pose) {
  Rigid3 a_from_b;
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column)
      a_from_b.rotation(row, column) = pose[static_cast<std::size_t>(4 * row + column)];
    a_from_b.translation[row] = pose[static_cast<std::size_t>(4 * row + 3)];
  }
  a_from_b.rotation = nearest_rotation(a_from_b.rotation);
  return a_from_b;
}

}  // namespace resight::bench
