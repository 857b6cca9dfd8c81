// SPDX-License-Identifier: Apache-2.0
#include "resight/modelling/internal/pixel_components.hpp"

#include <algorithm>

namespace resight {

std::vector<std::vector<int>> find_pixel_components(const OrganizedCloud& cloud, const Image<std::uint8_t>& set,
                                                    int max_gap_px, double max_jump_m) {
  const auto max_jump_sq = static_cast<float>(max_jump_m * max_jump_m);
  Image<std::uint8_t> open = set;
  std::vector<std::vector<int>> components;
  for (std::size_t start = 0; start < open.size(); ++start) {
    if (open[start] == 0) continue;
    open[start] = 0;
    std::vector<int> members{static_cast<int>(start)};
    for (std::size_t next = 0; next < members.size(); ++next) {
      const int u = members[next] % open.width();
      const int v = members[next] / open.width();
      const Eigen::Vector3f point = cloud.point(static_cast<std::size_t>(members[next]));
      for (int y = std::max(0, v - max_gap_px); y <= std::min(open.height() - 1, v + max_gap_px); ++y)
        for (int x = std::max(0, u - max_gap_px); x <= std::min(open.width() - 1, u + max_gap_px); ++x) {
          const std::size_t i = open.index(x, y);
          if (open[i] == 0 || (cloud.point(i) - point).squaredNorm() > max_jump_sq) continue;
          open[i] = 0;
          members.push_back(static_cast<int>(i));
        }
    }
    components.push_back(std::move(members));
  }
  return components;
}

}  // namespace resight
