// SPDX-License-Identifier: Apache-2.0
#include "resight/sensor/depth_edges.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "resight/core/check.hpp"

namespace resight {
namespace {

/// Number of steps from (u, v) to the nearest measurement in a direction, in [1, max_steps]; 0 if there is none.
int steps_to_measurement(const Image<float>& depth_m, int u, int v, int du, int dv, int max_steps) {
  for (int step = 1; step <= max_steps; ++step) {
    if (!depth_m.contains(u + step * du, v + step * dv)) return 0;
    if (!std::isnan(depth_m(u + step * du, v + step * dv))) return step;
  }
  return 0;
}

/// Depth of a missing pixel in a short gap of a surface; NaN otherwise.
float bridge_gap(const Image<float>& depth_m, int u, int v, const DepthEdgeOptions& options) {
  constexpr std::array<std::array<int, 2>, 4> kDirections{{{1, 0}, {0, 1}, {1, 1}, {1, -1}}};
  for (const auto& [du, dv] : kDirections) {
    const int ahead = steps_to_measurement(depth_m, u, v, du, dv, options.max_gap_px);
    if (ahead == 0) continue;
    const int behind = steps_to_measurement(depth_m, u, v, -du, -dv, options.max_gap_px + 1 - ahead);
    if (behind == 0) continue;
    const float a = depth_m(u + ahead * du, v + ahead * dv);
    const float b = depth_m(u - behind * du, v - behind * dv);
    if (std::abs(a - b) <= static_cast<float>(options.max_depth_jump) * std::min(a, b)) return (a + b) / 2;
  }
  return std::numeric_limits<float>::quiet_NaN();
}

Image<float> bridge_gaps(const Image<float>& depth_m, const DepthEdgeOptions& options) {
  Image<float> bridged = depth_m;
  for (int v = 0; v < depth_m.height(); ++v)
    for (int u = 0; u < depth_m.width(); ++u)
      if (std::isnan(depth_m(u, v))) bridged(u, v) = bridge_gap(depth_m, u, v, options);
  return bridged;
}

/// Marks in `is_edge` the pixels of row `z` whose neighbour in row `z_n`, shifted by `du` columns, is missing or
/// differs by more than the limit.
void mark_steps(std::span<const float> z, std::span<const float> z_n, int du, float max_jump, int* is_edge) {
  const int width = static_cast<int>(z.size());
  for (int u = std::max(0, -du); u < std::min(width, width - du); ++u) {
    const float other = z_n[u + du];
    const float nearer = z[u] < other ? z[u] : other;
    is_edge[u] |= std::abs(other - z[u]) <= max_jump * nearer ? 0 : 1;
  }
}

/// Vertical distance to the nearest edge in the column, in whole pixels; `far` if no edge is closer.
Image<int> column_distances(const Image<std::uint8_t>& edges, int far) {
  const int width = edges.width();
  const int height = edges.height();
  Image<int> distance(width, height);
  for (int v = 0; v < height; ++v) {
    const int* above = v > 0 ? distance.row(v - 1).data() : nullptr;
    const std::uint8_t* edge = edges.row(v).data();
    int* d = distance.row(v).data();
    for (int u = 0; u < width; ++u) d[u] = edge[u] != 0 ? 0 : std::min(far, above != nullptr ? above[u] + 1 : far);
  }
  for (int v = height - 2; v >= 0; --v) {
    const int* below = distance.row(v + 1).data();
    int* d = distance.row(v).data();
    for (int u = 0; u < width; ++u) d[u] = std::min(d[u], below[u] + 1);
  }
  return distance;
}

struct Rectangle {
  int begin_u, end_u;
  int begin_v, end_v;
  [[nodiscard]] std::int64_t area() const { return std::int64_t{end_u - begin_u} * (end_v - begin_v); }
};

Rectangle grown(const Rectangle& r, int by_px, const Rectangle& limits) {
  return {std::max(r.begin_u - by_px, limits.begin_u), std::min(r.end_u + by_px, limits.end_u),
          std::max(r.begin_v - by_px, limits.begin_v), std::min(r.end_v + by_px, limits.end_v)};
}

/// Bounding boxes of the changed pixels of each tile of the image.
std::vector<Rectangle> dirty_tiles(std::span<const int> changed_pixels, const Rectangle& image) {
  constexpr int kTile_px = 64;
  const int columns = image.end_u / kTile_px + 1;
  std::vector<Rectangle> tiles(static_cast<std::size_t>(columns * (image.end_v / kTile_px + 1)),
                               {image.end_u, 0, image.end_v, 0});
  for (const int i : changed_pixels) {
    const int u = i % image.end_u;
    const int v = i / image.end_u;
    Rectangle& tile = tiles[static_cast<std::size_t>(v / kTile_px * columns + u / kTile_px)];
    tile = {std::min(tile.begin_u, u), std::max(tile.end_u, u + 1), std::min(tile.begin_v, v),
            std::max(tile.end_v, v + 1)};
  }
  std::erase_if(tiles, [](const Rectangle& tile) { return tile.begin_u >= tile.end_u; });
  return tiles;
}

Image<float> cut_out(const Image<float>& image, const Rectangle& r) {
  Image<float> part(r.end_u - r.begin_u, r.end_v - r.begin_v);
  for (int v = r.begin_v; v < r.end_v; ++v)
    std::copy_n(image.row(v).begin() + r.begin_u, part.width(), part.row(v - r.begin_v).begin());
  return part;
}

}  // namespace

Image<std::uint8_t> find_depth_edges(const Image<float>& depth_m, const DepthEdgeOptions& options) {
  options.check();
  const int width = depth_m.width();
  const int height = depth_m.height();
  const auto max_jump = static_cast<float>(options.max_depth_jump);
  const Image<float> bridged = bridge_gaps(depth_m, options);
  Image<std::uint8_t> edges(width, height);
  std::vector<int> is_edge(static_cast<std::size_t>(width));
  for (int v = 0; v < height; ++v) {
    std::fill(is_edge.begin(), is_edge.end(), 0);
    for (int dv = v > 0 ? -1 : 0; dv <= (v + 1 < height ? 1 : 0); ++dv)
      for (int du = -1; du <= 1; ++du) mark_steps(bridged.row(v), bridged.row(v + dv), du, max_jump, is_edge.data());
    const float* z = depth_m.row(v).data();
    std::uint8_t* edge = edges.row(v).data();
    for (int u = 0; u < width; ++u) edge[u] = static_cast<std::uint8_t>(std::isnan(z[u]) ? 0 : is_edge[u]);
  }
  return edges;
}

Image<float> find_edge_distance(const Image<std::uint8_t>& edges, double max_distance_px) {
  check_positive("max_distance_px", max_distance_px);
  const int width = edges.width();
  // No edge is farther away than width + height. Pixels without an edge in reach get the cap.
  const int reach =
      static_cast<int>(std::min(std::floor(max_distance_px), static_cast<double>(width) + edges.height()));
  const int far = reach + 1;
  const auto cap = static_cast<float>(max_distance_px);
  const Image<int> column = column_distances(edges, far);
  Image<float> distance(width, edges.height());
  std::vector<int> best_sq(static_cast<std::size_t>(width));
  for (int v = 0; v < edges.height(); ++v) {
    std::fill(best_sq.begin(), best_sq.end(), far * far);
    const int* g = column.row(v).data();
    for (int du = -std::min(reach, width - 1); du <= std::min(reach, width - 1); ++du) {
      const int end = std::min(width, width - du);
      for (int u = std::max(0, -du); u < end; ++u) best_sq[u] = std::min(best_sq[u], g[u + du] * g[u + du] + du * du);
    }
    float* d = distance.row(v).data();
    for (int u = 0; u < width; ++u)
      d[u] = best_sq[u] >= far * far ? cap : std::min(std::sqrt(static_cast<float>(best_sq[u])), cap);
  }
  return distance;
}

void update_edge_distance(const Image<float>& depth_m, std::span<const int> changed_pixels,
                          const DepthEdgeOptions& options, Image<float>& edge_distance_px) {
  options.check();
  require(depth_m.width() == edge_distance_px.width() && depth_m.height() == edge_distance_px.height(),
          "update_edge_distance: the images differ in size");
  const Rectangle all{0, depth_m.width(), 0, depth_m.height()};
  const std::vector<Rectangle> dirty = dirty_tiles(changed_pixels, all);
  // A changed pixel affects edges at this distance, since pixels bridge gaps and a step has two sides. These edges
  // affect distances within `reach`.
  const double reach = std::min<double>(std::floor(options.max_distance_px), depth_m.width() + depth_m.height());
  const int edge_px = options.max_gap_px + 2;
  const int change_px = edge_px + static_cast<int>(reach) + 1;
  const int rim_px = change_px + static_cast<int>(reach) + edge_px;
  std::int64_t num_pixels = 0;
  for (const Rectangle& tile : dirty) num_pixels += grown(tile, rim_px, all).area();
  if (num_pixels > all.area() / 2) {
    edge_distance_px = find_edge_distance(find_depth_edges(depth_m, options), options.max_distance_px);
    return;
  }
  for (const Rectangle& tile : dirty) {
    const Rectangle from = grown(tile, rim_px, all);
    const Rectangle to = grown(tile, change_px, all);
    const Image<float> distance =
        find_edge_distance(find_depth_edges(cut_out(depth_m, from), options), options.max_distance_px);
    for (int v = to.begin_v; v < to.end_v; ++v)
      for (int u = to.begin_u; u < to.end_u; ++u) edge_distance_px(u, v) = distance(u - from.begin_u, v - from.begin_v);
  }
}

}  // namespace resight
