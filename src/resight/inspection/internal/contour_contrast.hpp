// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <vector>

#include "resight/core/image.hpp"
#include "resight/sensor/prepared_view.hpp"

/// Where the depth of a view says that the colours change.
namespace resight::inspection {

/// A pixel of a surface that ends there, before one that lies behind it.
struct ContourPixel {
  int u = 0;
  int v = 0;
  float depth_m = 0;
  bool along_row = false;  ///< It ends along its row of pixels, otherwise along its column.
};

/// Pixels of the occluding contours, evenly left out so that about 1,000 are left.
[[nodiscard]] std::vector<ContourPixel> find_contour_pixels(const PreparedView& view);

/// Contrast of the colours over three pixels along rows (or columns), grey levels up to 40. Depth ends within a pixel
/// or two of the contour.
[[nodiscard]] Image<float> find_contrast(const Image<Rgb8>& color, bool along_row);

}  // namespace resight::inspection
