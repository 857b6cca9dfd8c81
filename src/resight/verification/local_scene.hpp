// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "resight/geometry/block_grid.hpp"

namespace resight {

/// The scene points around one hypothesis on a dense grid: neighbours by a few contiguous runs instead of hash
/// look-ups.
class LocalScene {
 public:
  /// The points in the box around `around` widened by `margin_m`. Queries must lie in that box.
  LocalScene(std::span<const Eigen::Vector3f> scene, const BlockGrid& blocks, std::span<const Eigen::Vector3f> around,
             float margin_m, float cell_m);

  /// The points that are kept (one flag each), on the same grid.
  [[nodiscard]] LocalScene subset(std::span<const std::uint8_t> kept) const;

  [[nodiscard]] std::size_t size() const { return points_.size(); }
  [[nodiscard]] const Eigen::Vector3f& point(std::size_t local) const { return points_[local]; }
  /// Index in the whole scene.
  [[nodiscard]] int scene_index(std::size_t local) const { return indices_[local]; }

  /// The values of these points, selected from values of the whole scene; contiguous.
  template <typename T>
  [[nodiscard]] std::vector<T> select(const std::vector<T>& of_scene) const {
    std::vector<T> selected;
    selected.reserve(indices_.size());
    for (const int i : indices_) selected.push_back(of_scene[static_cast<std::size_t>(i)]);
    return selected;
  }

  /// Calls visit(local, distance_sq) for each point within the radius (boundary included), until it returns false.
  template <typename Visit>
  void visit_within(const Eigen::Vector3f& query, float radius_m, Visit&& visit) const {
    const Eigen::Vector3i low = cell_of(query.array() - radius_m);
    const Eigen::Vector3i high = cell_of(query.array() + radius_m);
    for (int ix = low.x(); ix <= high.x(); ++ix)
      for (int iy = low.y(); iy <= high.y(); ++iy) {
        const std::size_t row = (static_cast<std::size_t>(ix) * dims_.y() + iy) * dims_.z();
        for (int i = begin_[row + low.z()]; i < begin_[row + high.z() + 1]; ++i) {
          const float distance_sq = (points_[i] - query).squaredNorm();
          if (distance_sq <= radius_m * radius_m && !visit(static_cast<std::size_t>(i), distance_sq)) return;
        }
      }
  }

 private:
  [[nodiscard]] Eigen::Vector3i cell_of(const Eigen::Vector3f& p) const {
    const Eigen::Vector3f c = (p - min_) * inverse_cell_;
    return Eigen::Vector3i(static_cast<int>(std::floor(c.x())), static_cast<int>(std::floor(c.y())),
                           static_cast<int>(std::floor(c.z())))
        .cwiseMax(0)
        .cwiseMin(dims_ - Eigen::Vector3i::Ones());
  }

  LocalScene() = default;

  Eigen::Vector3f min_ = Eigen::Vector3f::Zero();
  float inverse_cell_ = 1;
  Eigen::Vector3i dims_ = Eigen::Vector3i::Ones();
  std::vector<int> begin_;
  std::vector<Eigen::Vector3f> points_;
  std::vector<int> indices_;
};

}  // namespace resight
