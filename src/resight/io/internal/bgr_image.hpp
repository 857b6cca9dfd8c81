// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <opencv2/core/mat.hpp>

#include "resight/core/image.hpp"

namespace resight::io {

/// An image of OpenCV with 8 bits per channel in the order blue, green, red.
[[nodiscard]] inline Image<Rgb8> from_bgr(const cv::Mat& bgr) {
  Image<Rgb8> color(bgr.cols, bgr.rows);
  for (int v = 0; v < bgr.rows; ++v) {
    const auto* source = bgr.ptr<unsigned char>(v);
    for (Rgb8& c : color.row(v)) {
      c = {source[2], source[1], source[0]};
      source += 3;
    }
  }
  return color;
}

}  // namespace resight::io
