// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <algorithm>
#include <cstddef>
#include <vector>

namespace resight {

/// Sums of values over rectangles of a grid, each in constant time (summed-area table; Crow 1984). `Value` is an Eigen
/// vector of integers, so that sums are exact. The sum over the whole grid must not overflow.
template <typename Value>
class AreaSums {
 public:
  /// `value_at(u, v)` gives the value of a cell.
  template <typename ValueAt>
  AreaSums(int width, int height, const ValueAt& value_at)
      : width_(width),
        height_(height),
        sums_((static_cast<std::size_t>(width) + 1) * (static_cast<std::size_t>(height) + 1), zero()) {
    for (int v = 0; v < height_; ++v) {
      Value row = zero();
      for (int u = 0; u < width_; ++u) {
        row += value_at(u, v);
        sums_[index(u + 1, v + 1)] = sums_[index(u + 1, v)] + row;
      }
    }
  }

  /// Over the cells from (left, top) to (right, bottom), inclusive, that lie in the grid.
  [[nodiscard]] Value sum(int left, int top, int right, int bottom) const {
    left = std::clamp(left, 0, width_);
    top = std::clamp(top, 0, height_);
    right = std::clamp(right + 1, left, width_);
    bottom = std::clamp(bottom + 1, top, height_);
    return sums_[index(right, bottom)] - sums_[index(left, bottom)] - sums_[index(right, top)] +
           sums_[index(left, top)];
  }

 private:
  static Value zero() { return Value::Zero(); }
  [[nodiscard]] std::size_t index(int u, int v) const {
    return static_cast<std::size_t>(v) * (static_cast<std::size_t>(width_) + 1) + static_cast<std::size_t>(u);
  }

  int width_;
  int height_;
  std::vector<Value> sums_;
};

}  // namespace resight
