// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <span>
#include <vector>

namespace resight::io {

/// Indices of two images that belong together.
struct TimePair {
  std::size_t color = 0;
  std::size_t depth = 0;
};

/// Pairs colour with depth images that lie at most `max_gap_s` apart in time: the nearest two first, then the nearest
/// of the others, as the tools of TUM do. An image is in one pair at most. Times that are not finite belong to no pair.
/// Images of one time are paired in their order. The pairs are in the order of the colour times.
[[nodiscard]] std::vector<TimePair> pair_by_time(std::span<const double> colors_s, std::span<const double> depths_s,
                                                 double max_gap_s);

}  // namespace resight::io
