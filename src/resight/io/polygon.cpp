// SPDX-License-Identifier: Apache-2.0
#include "resight/io/internal/polygon.hpp"

#include <Eigen/Geometry>
#include <algorithm>

namespace resight::io {
namespace {

class EarClipping {
 public:
  explicit EarClipping(std::span<const Eigen::Vector3f> polygon) {
    for (const Eigen::Vector3f& corner : polygon) {
      ring_.push_back(static_cast<int>(ring_.size()));
      corners_.push_back((corner - polygon[0]).cast<double>());
    }
    for (std::size_t i = 0; i < ring_.size(); ++i) normal_ += corners_[i].cross(corners_[next(i)]);
    for (std::size_t i = 0; i < ring_.size(); ++i) is_ear_.push_back(check_ear(i));
  }

  std::vector<std::array<int, 3>> run() {
    std::vector<std::array<int, 3>> triangles;
    while (ring_.size() > 3) {
      // A polygon that crosses itself may have no ear.
      const auto ear = std::find(is_ear_.begin() + 1, is_ear_.end(), true);
      const std::size_t tip =
          ear != is_ear_.end() ? static_cast<std::size_t>(ear - is_ear_.begin()) : std::size_t{is_ear_[0] ? 0U : 1U};
      triangles.push_back({ring_[previous(tip)], ring_[tip], ring_[next(tip)]});
      remove(tip);
    }
    triangles.push_back({ring_[0], ring_[1], ring_[2]});
    return triangles;
  }

 private:
  [[nodiscard]] std::size_t next(std::size_t i) const { return i + 1 < ring_.size() ? i + 1 : 0; }
  [[nodiscard]] std::size_t previous(std::size_t i) const { return (i > 0 ? i : ring_.size()) - 1; }

  /// Positive if the path from a over b to c turns left, seen against the normal.
  [[nodiscard]] double turn(int a, int b, int c) const {
    return (corners_[b] - corners_[a]).cross(corners_[c] - corners_[b]).dot(normal_);
  }

  /// Whether the triangle of a corner and its neighbours is part of the polygon, with no other corner in it or on its
  /// edges. Corners may lie on each other where a polygon has a hole.
  [[nodiscard]] bool check_ear(std::size_t tip) const {
    const int a = ring_[previous(tip)];
    const int b = ring_[tip];
    const int c = ring_[next(tip)];
    const auto is_inside = [&](int p) {
      return turn(a, b, p) >= 0 && turn(b, c, p) >= 0 && turn(c, a, p) >= 0 && corners_[p] != corners_[a] &&
             corners_[p] != corners_[b] && corners_[p] != corners_[c];
    };
    return turn(a, b, c) > 0 && std::ranges::none_of(ring_, is_inside);
  }

  void remove(std::size_t tip) {
    ring_.erase(ring_.begin() + static_cast<std::ptrdiff_t>(tip));
    is_ear_.erase(is_ear_.begin() + static_cast<std::ptrdiff_t>(tip));
    const std::size_t after = tip < ring_.size() ? tip : 0;
    for (const std::size_t i : {previous(after), after}) is_ear_[i] = check_ear(i);
  }

  std::vector<Eigen::Vector3d> corners_;  ///< Relative to the first.
  std::vector<int> ring_;                 ///< The corners that are left.
  std::vector<bool> is_ear_;              ///< Of the corners in the ring.
  Eigen::Vector3d normal_ = Eigen::Vector3d::Zero();
};

}  // namespace

std::vector<std::array<int, 3>> triangulate(std::span<const Eigen::Vector3f> polygon) {
  return EarClipping(polygon).run();
}

}  // namespace resight::io
