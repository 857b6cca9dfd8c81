// SPDX-License-Identifier: Apache-2.0
#include "resight/sensor/pixel_components.hpp"

#include <algorithm>

namespace resight {
namespace {

/// `connects(i, j)`: whether neighbouring pixels belong together.
template <typename Connects>
std::vector<std::vector<int>> find_components(const Image<std::uint8_t>& set, int max_gap_px, Connects&& connects) {
  Image<std::uint8_t> open = set;
  std::vector<std::vector<int>> components;
  for (std::size_t start = 0; start < open.size(); ++start) {
    if (open[start] == 0) continue;
    open[start] = 0;
    std::vector<int> members{static_cast<int>(start)};
    for (std::size_t next = 0; next < members.size(); ++next) {
      const auto member = static_cast<std::size_t>(members[next]);
      const int u = members[next] % open.width();
      const int v = members[next] / open.width();
      for (int y = std::max(0, v - max_gap_px); y <= std::min(open.height() - 1, v + max_gap_px); ++y)
        for (int x = std::max(0, u - max_gap_px); x <= std::min(open.width() - 1, u + max_gap_px); ++x) {
          const std::size_t i = open.index(x, y);
          if (open[i] == 0 || !connects(i, member)) continue;
          open[i] = 0;
          members.push_back(static_cast<int>(i));
        }
    }
    components.push_back(std::move(members));
  }
  return components;
}

}  // namespace

std::vector<std::vector<int>> find_pixel_components(const Image<std::uint8_t>& set, int max_gap_px) {
  return find_components(set, max_gap_px, [](std::size_t, std::size_t) { return true; });
}

std::vector<std::vector<int>> find_pixel_components(const OrganizedCloud& cloud, const Image<std::uint8_t>& set,
                                                    int max_gap_px, double max_jump_m) {
  const auto max_jump_sq = static_cast<float>(max_jump_m * max_jump_m);
  return find_components(set, max_gap_px, [&](std::size_t i, std::size_t j) {
    return !((cloud.point(i) - cloud.point(j)).squaredNorm() > max_jump_sq);
  });
}

}  // namespace resight
