// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cassert>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

namespace resight {

/// 8-bit sRGB colour.
struct Rgb8 {
  std::uint8_t r = 0;
  std::uint8_t g = 0;
  std::uint8_t b = 0;
  friend bool operator==(const Rgb8&, const Rgb8&) = default;
};

/// Row-major image without padding. (u, v) = (column, row); pixel centres are at whole numbers.
template <typename T>
class Image {
 public:
  Image() = default;
  Image(int width, int height, T value = T{})
      : width_(width),
        height_(height),
        data_(static_cast<std::size_t>(width) * static_cast<std::size_t>(height), value) {}
  /// Takes ownership of `data`, which holds width * height values in row-major order.
  Image(int width, int height, std::vector<T> data) : width_(width), height_(height), data_(std::move(data)) {
    assert(data_.size() == static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
  }

  [[nodiscard]] int width() const { return width_; }
  [[nodiscard]] int height() const { return height_; }
  [[nodiscard]] std::size_t size() const { return data_.size(); }
  [[nodiscard]] bool empty() const { return data_.empty(); }
  [[nodiscard]] bool contains(int u, int v) const { return u >= 0 && v >= 0 && u < width_ && v < height_; }
  [[nodiscard]] std::size_t index(int u, int v) const {
    return static_cast<std::size_t>(v) * static_cast<std::size_t>(width_) + static_cast<std::size_t>(u);
  }

  T& operator()(int u, int v) { return data_[index(u, v)]; }
  const T& operator()(int u, int v) const { return data_[index(u, v)]; }
  T& operator[](std::size_t i) { return data_[i]; }
  const T& operator[](std::size_t i) const { return data_[i]; }

  [[nodiscard]] std::span<T> data() { return data_; }
  [[nodiscard]] std::span<const T> data() const { return data_; }
  [[nodiscard]] std::span<T> row(int v) { return data().subspan(index(0, v), static_cast<std::size_t>(width_)); }
  [[nodiscard]] std::span<const T> row(int v) const {
    return data().subspan(index(0, v), static_cast<std::size_t>(width_));
  }
  friend bool operator==(const Image&, const Image&) = default;

 private:
  int width_ = 0;
  int height_ = 0;
  std::vector<T> data_;
};

}  // namespace resight
