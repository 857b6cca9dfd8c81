// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <algorithm>
#include <vector>

#include "resight/geometry/camera.hpp"

namespace resight {

/// Tells without an index which points cannot be near to any point of a set. The image is cut into tiles; each knows
/// the depths at which a point of the set may lie within the radius of a point that projects there. Points outside the
/// image count for the tile at the border that is nearest. A few nanoseconds a point; camera frame, metres.
class DepthTiles {
 public:
  /// Of an empty set. `radius_m` > 0.
  DepthTiles(const Camera& camera, double radius_m);

  /// A finite point, which may lie outside the image or behind the camera.
  void add(const Eigen::Vector3f& p_in_camera);
  /// The point behind pixel (u, v) of the image at depth z > 0: the same, cheaper.
  void add_pixel(int u, int v, float z);
  /// To be called once, between the last add() and the first question.
  void close();

  /// False only if no point of the set lies within the radius of `p_in_camera`.
  [[nodiscard]] bool may_be_near(const Eigen::Vector3f& p_in_camera) const {
    const float z = p_in_camera.z();
    if (!(z > 0)) return behind_camera_;
    return may_be_near(focal_x_ * p_in_camera.x() / z + center_x_, focal_y_ * p_in_camera.y() / z + center_y_, z);
  }
  /// The same of a point at depth z > 0 that projects to (u, v), which may lie outside the image.
  [[nodiscard]] bool may_be_near(float u, float v, float z) const {
    const DepthRange& range = near_[static_cast<std::size_t>(tile_of(u, v))];
    return z >= range.min_m && z <= range.max_m;
  }

 private:
  struct DepthRange {
    float min_m;
    float max_m;
    void include(const DepthRange& other);
  };
  [[nodiscard]] int tile_of(float u, float v) const {
    // In this order NaN becomes a number.
    const int column = static_cast<int>(std::max(0.0F, std::min(last_u_, u))) >> kTileShift;
    const int row = static_cast<int>(std::max(0.0F, std::min(last_v_, v))) >> kTileShift;
    return row * columns_ + column;
  }
  void spread(int column, int row, int reach_tiles, const DepthRange& range);
  [[nodiscard]] double slope_sq_of_tile(int column, int row) const;

  static constexpr int kTileShift = 3;  // 8 px

  Camera camera_;
  float focal_x_, focal_y_, center_x_, center_y_, last_u_, last_v_;  // px
  double radius_m_;
  int columns_;
  int rows_;
  std::vector<DepthRange> own_;   // Of the points that project to a tile.
  std::vector<float> slope_sq_;   // Largest (x/z)^2 + (y/z)^2 of those outside the image.
  std::vector<DepthRange> near_;  // Of what may be near to them.
  bool behind_camera_ = false;    // What lies behind the camera may be near.
};

}  // namespace resight
