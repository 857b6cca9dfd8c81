// SPDX-License-Identifier: Apache-2.0
#include "resight/changes/depth_tiles.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "resight/core/check.hpp"

namespace resight {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr double kSlack = 1.0 + 1e-4;  // Distances are tested in single precision.
constexpr double kSlack_px = 1.0;      // Points lie within a pixel of where they are said to project to.

}  // namespace

void DepthTiles::DepthRange::include(const DepthRange& other) {
  min_m = std::min(min_m, other.min_m);
  max_m = std::max(max_m, other.max_m);
}

DepthTiles::DepthTiles(const Camera& camera, double radius_m)
    : camera_(camera),
      focal_x_(static_cast<float>(camera.fx)),
      focal_y_(static_cast<float>(camera.fy)),
      center_x_(static_cast<float>(camera.cx)),
      center_y_(static_cast<float>(camera.cy)),
      last_u_(static_cast<float>(camera.width - 1)),
      last_v_(static_cast<float>(camera.height - 1)),
      radius_m_((check_positive("radius_m", radius_m), radius_m * kSlack)),
      columns_((camera.width >> kTileShift) + 1),
      rows_((camera.height >> kTileShift) + 1) {
  require(camera.is_valid(), "DepthTiles: invalid intrinsics (size and focal lengths must be positive and finite)");
  const auto size = static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_);
  own_.assign(size, {kInfinity, -kInfinity});
  near_.assign(size, {kInfinity, -kInfinity});
  slope_sq_.assign(size, 0);
}

void DepthTiles::add_pixel(int u, int v, float z) {
  own_[static_cast<std::size_t>((v >> kTileShift) * columns_ + (u >> kTileShift))].include({z, z});
}

void DepthTiles::add(const Eigen::Vector3f& p_in_camera) {
  const float z = p_in_camera.z();
  if (!(z > radius_m_)) {
    behind_camera_ = true;
    if (z > -radius_m_) own_[0].include({z, z});  // Makes close() spread it over all tiles.
    return;
  }
  const float x_over_z = p_in_camera.x() / z;
  const float y_over_z = p_in_camera.y() / z;
  const int tile = tile_of(focal_x_ * x_over_z + center_x_, focal_y_ * y_over_z + center_y_);
  own_[tile].include({z, z});
  slope_sq_[tile] = std::max(slope_sq_[tile], x_over_z * x_over_z + y_over_z * y_over_z);
}

double DepthTiles::slope_sq_of_tile(int column, int row) const {
  const auto farthest = [](int tile, double center_px, double focal_px) {
    const double begin = (tile << kTileShift) - center_px;
    return std::max(std::abs(begin), std::abs(begin + (1 << kTileShift))) / focal_px;
  };
  const double x = farthest(column, camera_.cx, camera_.fx);
  const double y = farthest(row, camera_.cy, camera_.fy);
  return x * x + y * y;
}

void DepthTiles::spread(int column, int row, int reach_tiles, const DepthRange& range) {
  for (int r = std::max(row - reach_tiles, 0); r <= std::min(row + reach_tiles, rows_ - 1); ++r)
    for (int c = std::max(column - reach_tiles, 0); c <= std::min(column + reach_tiles, columns_ - 1); ++c)
      near_[static_cast<std::size_t>(r * columns_ + c)].include(range);
}

// Let p lie within r of q, s be the slope x/z of q. Then f x_p/z_p - f s = f ((x_p - x_q) - s (z_p - z_q)) / z_p, which
// is at most f r sqrt(1 + s^2) / (z_q - r): so far apart are their pixels, at most.
void DepthTiles::close() {
  for (int row = 0; row < rows_; ++row)
    for (int column = 0; column < columns_; ++column) {
      const auto tile = static_cast<std::size_t>(row * columns_ + column);
      const DepthRange own = own_[tile];
      if (own.min_m > own.max_m) continue;
      const auto radius_m = static_cast<float>(radius_m_);
      const DepthRange range{own.min_m - radius_m, own.max_m + radius_m};
      if (!(range.min_m > 0)) {
        behind_camera_ = true;
        spread(column, row, std::max(columns_, rows_), range);
        continue;
      }
      const double slope_sq = std::max<double>(slope_sq_[tile], slope_sq_of_tile(column, row));
      const double focal_px = std::max(camera_.fx, camera_.fy);
      const double reach_px = focal_px * radius_m_ * std::sqrt(1 + slope_sq) / range.min_m + kSlack_px;
      const double reach_tiles = std::ceil(reach_px / (1 << kTileShift));
      spread(column, row, static_cast<int>(std::min<double>(reach_tiles, std::max(columns_, rows_))), range);
    }
}

}  // namespace resight
