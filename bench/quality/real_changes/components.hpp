// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <vector>

#include "resight/core/image.hpp"

namespace resight::bench {

/// Zero or not zero per pixel.
using Mask = Image<std::uint8_t>;

/// Connected pixels of one key, as ascending indices into the image.
using Region = std::vector<int>;

struct Components {
  std::vector<Region> regions;
  Image<int> numbers;  ///< Of the region at each pixel; -1: none.
};

/// Regions of equal keys (8 neighbours). Pixels with key 0 belong to none.
[[nodiscard]] Components find_components(const Image<std::int32_t>& keys);
/// Regions of non-zero pixels.
[[nodiscard]] Components find_components(const Mask& mask);

}  // namespace resight::bench
