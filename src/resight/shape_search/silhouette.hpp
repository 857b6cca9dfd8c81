// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <span>
#include <vector>

namespace resight {

/// The outline of an object in the image, as cells that its samples fall into.
class Silhouette {
 public:
  /// At least one sample; pixels.
  Silhouette(std::span<const Eigen::Vector2f> samples_px, float cell_px) : cell_px_(cell_px) {
    Eigen::Vector2f max = samples_px.front();
    min_ = max;
    for (const Eigen::Vector2f& p : samples_px) {
      min_ = min_.cwiseMin(p);
      max = max.cwiseMax(p);
    }
    width_ = static_cast<int>((max.x() - min_.x()) / cell_px) + 1 + 2 * kMargin;
    height_ = static_cast<int>((max.y() - min_.y()) / cell_px) + 1 + 2 * kMargin;
    cells_.assign(static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_), kEmpty);
    for (const Eigen::Vector2f& p : samples_px) cells_[index(p)] = kInside;
  }

  /// Stores a value >= 0 for the cell of a sample.
  void set_known(const Eigen::Vector2f& sample_px, int known) { cells_[index(sample_px)] = known; }

  /// Visits the empty cells two cells away from the object; the rim between is smeared by sensors. Calls
  /// visit(middle_px, value) with the values of nearby cells until it returns true.
  template <typename Visit>
  void visit_around(Visit&& visit) const {
    for (int y = 0; y < height_; ++y)
      for (int x = 0; x < width_; ++x)
        if (distance_to_object(x, y) == kMargin) visit_known_near(x, y, visit);
  }

 private:
  static constexpr int kMargin = 2;
  static constexpr int kEmpty = -2;
  static constexpr int kInside = -1;

  [[nodiscard]] std::size_t index(const Eigen::Vector2f& p) const {
    return at(static_cast<int>((p.x() - min_.x()) / cell_px_) + kMargin,
              static_cast<int>((p.y() - min_.y()) / cell_px_) + kMargin);
  }
  [[nodiscard]] std::size_t at(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) + static_cast<std::size_t>(x);
  }

  // In cells, to the side or across; kMargin + 1 if farther.
  [[nodiscard]] int distance_to_object(int x, int y) const {
    int nearest = kMargin + 1;
    visit_near(x, y, [&](int distance, int cell) {
      if (cell != kEmpty) nearest = std::min(nearest, distance);
      return false;
    });
    return nearest;
  }

  template <typename Visit>
  void visit_known_near(int x, int y, Visit& visit) const {
    const Eigen::Vector2f middle = min_ + cell_px_ * Eigen::Vector2f(static_cast<float>(x - kMargin) + 0.5F,
                                                                     static_cast<float>(y - kMargin) + 0.5F);
    visit_near(x, y, [&](int, int cell) { return cell >= 0 && visit(middle, cell); });
  }

  template <typename Visit>
  void visit_near(int x, int y, Visit&& visit) const {
    for (int ny = std::max(0, y - kMargin); ny <= std::min(height_ - 1, y + kMargin); ++ny)
      for (int nx = std::max(0, x - kMargin); nx <= std::min(width_ - 1, x + kMargin); ++nx)
        if (visit(std::max(std::abs(nx - x), std::abs(ny - y)), cells_[at(nx, ny)])) return;
  }

  float cell_px_;
  Eigen::Vector2f min_;
  int width_ = 0;
  int height_ = 0;
  std::vector<int> cells_;
};

}  // namespace resight
