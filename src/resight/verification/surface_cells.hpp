// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <cstddef>
#include <span>
#include <vector>

#include "resight/appearance/lab_color.hpp"
#include "resight/geometry/voxel_map.hpp"

namespace resight {

/// Means of colours over cubes of a surface, which are enough for what changes slowly along it.
class SurfaceCells {
 public:
  SurfaceCells(std::span<const Eigen::Vector3f> points, double side_m) {
    VoxelMap cells;
    for (const Eigen::Vector3f& p : points) {
      const auto cell = static_cast<std::size_t>(cells.insert(voxel_key(p, static_cast<float>(1 / side_m))));
      cell_of_.push_back(cell);
      if (cell == num_points_.size()) {
        num_points_.push_back(0);
        centers_.emplace_back(Eigen::Vector3f::Zero());
      }
      centers_[cell] += (p - centers_[cell]) / ++num_points_[cell];
    }
  }
  [[nodiscard]] const std::vector<Eigen::Vector3f>& centers() const { return centers_; }
  [[nodiscard]] float num_points(std::size_t cell) const { return num_points_[cell]; }
  [[nodiscard]] std::size_t cell_of(std::size_t point) const { return cell_of_[point]; }
  [[nodiscard]] std::vector<LabColor> means(std::span<const LabColor> colors) const {
    std::vector<LabColor> means(centers_.size());
    for (std::size_t i = 0; i < colors.size(); ++i) {
      LabColor& mean = means[cell_of_[i]];
      const float share = 1 / num_points_[cell_of_[i]];
      mean = {mean.l + share * colors[i].l, mean.a + share * colors[i].a, mean.b + share * colors[i].b};
    }
    return means;
  }

 private:
  std::vector<std::size_t> cell_of_;
  std::vector<float> num_points_;
  std::vector<Eigen::Vector3f> centers_;
};

}  // namespace resight
