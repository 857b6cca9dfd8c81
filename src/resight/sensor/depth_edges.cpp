// SPDX-License-Identifier: Apache-2.0
#include "resight/sensor/depth_edges.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <span>
#include <vector>

#include "resight/core/check.hpp"

namespace resight {
namespace {

/// Steps from (u, v) to the nearest measurement in a direction, in [1, max_steps]; 0 if there is none.
int steps_to_measurement(const Image<float>& depth_m, int u, int v, int du, int dv, int max_steps) {
  for (int step = 1; step <= max_steps; ++step) {
    if (!depth_m.contains(u + step * du, v + step * dv)) return 0;
    if (!std::isnan(depth_m(u + step * du, v + step * dv))) return step;
  }
  return 0;
}

/// Depth of a missing pixel that lies in a short gap of a surface, else NaN.
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

/// Marks in `is_edge` the pixels of row `z` whose neighbour `du` columns on in row `z_n` is missing or beyond the
/// limit.
void mark_steps(std::span<const float> z, std::span<const float> z_n, int du, float max_jump, int* is_edge) {
  const int width = static_cast<int>(z.size());
  for (int u = std::max(0, -du); u < std::min(width, width - du); ++u) {
    const float other = z_n[u + du];
    const float nearer = z[u] < other ? z[u] : other;
    is_edge[u] |= std::abs(other - z[u]) <= max_jump * nearer ? 0 : 1;
  }
}

/// Vertical distance to the nearest edge of the column, in whole pixels; `far` where there is none nearer than that.
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

}  // namespace

void DepthEdgeOptions::check() const {
  check_positive("DepthEdgeOptions.max_depth_jump", max_depth_jump);
  check_in_range("DepthEdgeOptions.max_gap_px", max_gap_px, 0, 1000);
  check_positive("DepthEdgeOptions.max_distance_px", max_distance_px);
}

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
  // Nothing lies farther off than the sides of the image; without an edge the answer is the cap.
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

}  // namespace resight
