// SPDX-License-Identifier: Apache-2.0
#include "resight/annotation/pixel_runs.hpp"

#include <algorithm>

namespace resight {
namespace {

constexpr int kMaxMaskPixels = 1 << 24;  // Of a recorded image (docs/formats.md).

}  // namespace

PixelRuns find_runs(const Image<std::uint8_t>& mask) {
  PixelRuns runs;
  for (std::size_t i = 0; i < mask.size(); ++i) {
    if (mask[i] == 0) continue;
    const int pixel = static_cast<int>(i);
    if (!runs.empty() && runs.back().first + runs.back().count == pixel)
      ++runs.back().count;
    else
      runs.push_back({pixel, 1});
  }
  return runs;
}

Image<std::uint8_t> make_mask(const PixelRuns& runs, int width, int height) {
  Image<std::uint8_t> mask(width, height);
  const int num_pixels = static_cast<int>(mask.size());
  for (const PixelRun& run : runs)
    for (int i = run.first; i < std::min(num_pixels, run.first + run.count); ++i)
      mask[static_cast<std::size_t>(i)] = 255;
  return mask;
}

Result<void> check_runs(const PixelRuns& runs) {
  int end = 0;
  for (const PixelRun& run : runs) {
    if (run.first < end || run.count < 1 || run.first >= kMaxMaskPixels || run.count > kMaxMaskPixels - run.first)
      return Error{"the runs of a mask do not ascend, or exceed the largest image"};
    end = run.first + run.count;
  }
  return {};
}

}  // namespace resight
