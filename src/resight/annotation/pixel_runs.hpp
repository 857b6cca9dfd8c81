// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <vector>

#include "resight/core/image.hpp"
#include "resight/core/result.hpp"

namespace resight {

/// Consecutive pixels of an image, row by row.
struct PixelRun {
  int first = 0;  ///< Index of the pixel: v * width + u.
  int count = 0;
  friend bool operator==(const PixelRun&, const PixelRun&) = default;
};
/// A mask as ascending runs that do not touch.
using PixelRuns = std::vector<PixelRun>;

/// The runs of the pixels that are not 0.
[[nodiscard]] PixelRuns find_runs(const Image<std::uint8_t>& mask);

/// A mask of 0 and 255. Pixels beyond the image are left out.
[[nodiscard]] Image<std::uint8_t> make_mask(const PixelRuns& runs, int width, int height);

/// Fails unless the runs ascend, do not overlap, and end within the largest image that resight reads.
[[nodiscard]] Result<void> check_runs(const PixelRuns& runs);

}  // namespace resight
