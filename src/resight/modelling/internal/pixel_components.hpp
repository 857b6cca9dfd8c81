// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <vector>

#include "resight/sensor/organized_cloud.hpp"

namespace resight {

/// Connected parts of the pixels that are set, each in order of discovery: pixels at most `max_gap_px` rows and columns
/// apart whose points are at most `max_jump_m` apart are connected. All pixels that are set must have a point.
[[nodiscard]] std::vector<std::vector<int>> find_pixel_components(const OrganizedCloud& cloud,
                                                                  const Image<std::uint8_t>& set, int max_gap_px,
                                                                  double max_jump_m);

}  // namespace resight
