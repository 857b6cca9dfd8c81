// SPDX-License-Identifier: Apache-2.0
#include "resight/geometry/oriented_box.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>

#include "resight/core/check.hpp"

namespace resight {

OrientedBox fit_box(const PointCloud& cloud_in_world) {
  require(!cloud_in_world.empty(), "fit_box: the cloud is empty");
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3f& p : cloud_in_world.points) mean += p.cast<double>();
  mean /= static_cast<double>(cloud_in_world.size());
  Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
  for (const Eigen::Vector3f& p : cloud_in_world.points) {
    const Eigen::Vector3d d = p.cast<double>() - mean;
    scatter += d * d.transpose();
  }
  const Eigen::Matrix3d axes = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(scatter).eigenvectors();
  Eigen::Vector3d low = Eigen::Vector3d::Zero();
  Eigen::Vector3d high = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3f& p : cloud_in_world.points) {
    const Eigen::Vector3d along = axes.transpose() * (p.cast<double>() - mean);
    low = low.cwiseMin(along);
    high = high.cwiseMax(along);
  }
  // Sides from the longest to the shortest; a third axis that makes the frame right-handed.
  std::array<int, 3> order{0, 1, 2};
  const Eigen::Vector3d size_m = high - low;
  std::ranges::stable_sort(order, [&](int a, int b) { return size_m[a] > size_m[b]; });
  OrientedBox box;
  for (int i = 0; i < 3; ++i) box.size_m[i] = size_m[order[static_cast<std::size_t>(i)]];
  box.world_from_box.translation = mean + axes * (low + high) / 2;
  box.world_from_box.rotation << axes.col(order[0]), axes.col(order[1]), axes.col(order[0]).cross(axes.col(order[1]));
  return box;
}

}  // namespace resight
