// SPDX-License-Identifier: Apache-2.0
#include "resight/geometry/oriented_box.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <utility>
#include <vector>

#include "resight/core/check.hpp"

namespace resight {
namespace {

using Points = std::vector<Eigen::Vector3d>;

// A stray, such as a flying pixel, lies beyond the range of nearly all points by more than a tenth of that range.
constexpr double kStrayShare = 0.02;  // At either end.
constexpr double kStrayReach = 0.1;
constexpr double kLeastReach_m = 0.005;
constexpr int kMaxRounds = 3;  // Strays turn the axes, so more of them show when some are left out.

struct Axes {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  Eigen::Matrix3d directions;  ///< As columns.
  [[nodiscard]] Eigen::Vector3d along(const Eigen::Vector3d& p) const { return directions.transpose() * (p - mean); }
};

Axes find_principal_axes(const Points& points) {
  Axes axes;
  for (const Eigen::Vector3d& p : points) axes.mean += p;
  axes.mean /= static_cast<double>(points.size());
  Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
  for (const Eigen::Vector3d& p : points) {
    const Eigen::Vector3d d = p - axes.mean;
    scatter += d * d.transpose();
  }
  axes.directions = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(scatter).eigenvectors();
  return axes;
}

double quantile(std::vector<double>& values, double share) {
  const auto place = values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::ranges::nth_element(values, place);
  return *place;
}

Points drop_strays(const Points& points, const Axes& axes) {
  Eigen::Vector3d low, high;
  std::vector<double> values(points.size());
  for (int axis = 0; axis < 3; ++axis) {
    std::ranges::transform(points, values.begin(), [&](const Eigen::Vector3d& p) { return axes.along(p)[axis]; });
    low[axis] = quantile(values, kStrayShare);
    high[axis] = quantile(values, 1 - kStrayShare);
  }
  const Eigen::Vector3d reach = kStrayReach * (high - low) + Eigen::Vector3d::Constant(kLeastReach_m);
  Points kept;
  for (const Eigen::Vector3d& p : points) {
    const Eigen::Array3d along = axes.along(p).array();
    if ((along >= (low - reach).array()).all() && (along <= (high + reach).array()).all()) kept.push_back(p);
  }
  return kept;
}

}  // namespace

OrientedBox fit_box(const PointCloud& cloud_in_world) {
  require(!cloud_in_world.empty(), "fit_box: the cloud is empty");
  Points points;
  for (const Eigen::Vector3f& p : cloud_in_world.points) points.push_back(p.cast<double>());
  Axes axes = find_principal_axes(points);
  for (int round = 0; round < kMaxRounds; ++round) {
    Points kept = drop_strays(points, axes);
    if (kept.size() == points.size()) break;
    points = std::move(kept);
    axes = find_principal_axes(points);
  }
  Eigen::Vector3d low = Eigen::Vector3d::Zero();
  Eigen::Vector3d high = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& p : points) {
    low = low.cwiseMin(axes.along(p));
    high = high.cwiseMax(axes.along(p));
  }
  // Sides from the longest to the shortest; a third axis that makes the frame right-handed.
  std::array<int, 3> order{0, 1, 2};
  const Eigen::Vector3d size_m = high - low;
  std::ranges::stable_sort(order, [&](int a, int b) { return size_m[a] > size_m[b]; });
  OrientedBox box;
  for (int i = 0; i < 3; ++i) box.size_m[i] = size_m[order[static_cast<std::size_t>(i)]];
  box.world_from_box.translation = axes.mean + axes.directions * (low + high) / 2;
  const Eigen::Vector3d x = axes.directions.col(order[0]), y = axes.directions.col(order[1]);
  box.world_from_box.rotation << x, y, x.cross(y);
  return box;
}

}  // namespace resight
