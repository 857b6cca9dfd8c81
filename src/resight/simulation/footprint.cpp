// SPDX-License-Identifier: Apache-2.0
#include "resight/simulation/internal/footprint.hpp"

#include <cmath>
#include <numbers>

#include "resight/geometry/rigid3.hpp"

namespace resight {
namespace {

// Half the extent of the rectangle along the given direction.
double half_extent(const Footprint& f, const Eigen::Vector2d& direction) {
  const Eigen::Vector2d x_axis(std::cos(f.yaw_rad), std::sin(f.yaw_rad));
  const Eigen::Vector2d y_axis(-x_axis.y(), x_axis.x());
  return f.half_size.x() * std::abs(direction.dot(x_axis)) + f.half_size.y() * std::abs(direction.dot(y_axis));
}

}  // namespace

Footprint footprint_of(const TriangleMesh& mesh, double roll_rad) {
  const Eigen::Matrix3f r = Rigid3::from_axis_angle(Eigen::Vector3d::UnitX(), roll_rad).rotation.cast<float>();
  Eigen::Vector2f low = (r * mesh.vertices.front()).head<2>();
  Eigen::Vector2f high = low;
  for (const auto& v : mesh.vertices) {
    const Eigen::Vector2f p = (r * v).head<2>();
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  return {(0.5F * (low + high)).cast<double>(), (0.5F * (high - low)).cast<double>(), 0};
}

bool overlaps(const Footprint& a, const Footprint& b, double gap_m) {
  for (const Footprint* f : {&a, &b})
    for (const double quarter : {0.0, 1.0}) {
      const double angle = f->yaw_rad + quarter * std::numbers::pi / 2;
      const Eigen::Vector2d axis(std::cos(angle), std::sin(angle));
      const double distance = std::abs(axis.dot(a.center - b.center));
      if (distance >= half_extent(a, axis) + half_extent(b, axis) + gap_m) return false;
    }
  return true;
}

bool lies_within(const Footprint& footprint, const Eigen::Vector2d& half_area) {
  return std::abs(footprint.center.x()) + half_extent(footprint, Eigen::Vector2d::UnitX()) <= half_area.x() &&
         std::abs(footprint.center.y()) + half_extent(footprint, Eigen::Vector2d::UnitY()) <= half_area.y();
}

}  // namespace resight
