// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <vector>

#include "resight/sensor/organized_cloud.hpp"

namespace resight {

/// Connected components of the non-zero pixels of `set`, each in order of discovery. Pixels are connected if they are
/// at most `max_gap_px` rows and columns apart.
[[nodiscard]] std::vector<std::vector<int>> find_pixel_components(const Image<std::uint8_t>& set, int max_gap_px);

/// The same, but the points of connected pixels are also at most `max_jump_m` apart. All non-zero pixels must have a
/// point.
[[nodiscard]] std::vector<std::vector<int>> find_pixel_components(const OrganizedCloud& cloud,
                                                                  const Image<std::uint8_t>& set, int max_gap_px,
                                                                  double max_jump_m);

}  // namespace resight
