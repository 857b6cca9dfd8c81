// SPDX-License-Identifier: Apache-2.0
#include "components.hpp"

#include <algorithm>

namespace resight::bench {
namespace {

// Collects the region that holds pixel `start`, and numbers its pixels.
Region grow_region(const Image<std::int32_t>& keys, int start, int number, Image<int>& numbers) {
  Region region{start};
  numbers[start] = number;
  for (std::size_t next = 0; next < region.size(); ++next) {
    const int u = region[next] % keys.width();
    const int v = region[next] / keys.width();
    for (int row = std::max(0, v - 1); row <= std::min(keys.height() - 1, v + 1); ++row)
      for (int column = std::max(0, u - 1); column <= std::min(keys.width() - 1, u + 1); ++column) {
        const int pixel = static_cast<int>(keys.index(column, row));
        if (numbers[pixel] >= 0 || keys[pixel] != keys[start]) continue;
        numbers[pixel] = number;
        region.push_back(pixel);
      }
  }
  std::ranges::sort(region);
  return region;
}

}  // namespace

Components find_components(const Image<std::int32_t>& keys) {
  Components components{{}, Image<int>(keys.width(), keys.height(), -1)};
  for (int pixel = 0; pixel < static_cast<int>(keys.size()); ++pixel) {
    if (keys[pixel] == 0 || components.numbers[pixel] >= 0) continue;
    const int number = static_cast<int>(components.regions.size());
    components.regions.push_back(grow_region(keys, pixel, number, components.numbers));
  }
  return components;
}

Components find_components(const Mask& mask) {
  Image<std::int32_t> keys(mask.width(), mask.height());
  std::ranges::transform(mask.data(), keys.data().begin(), [](std::uint8_t value) { return value != 0 ? 1 : 0; });
  return find_components(keys);
}

}  // namespace resight::bench
