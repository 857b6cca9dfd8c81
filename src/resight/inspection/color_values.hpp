// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "resight/core/image.hpp"

namespace resight {

/// What the colours of a view tell without its depth.
struct ColorValues {
  double bright_grey = 0;  ///< 95 % of the pixels are darker, in grey levels (0..255).
  /// Width of the edges along rows and along columns, px of an image 640 px long (of smaller images: their own px):
  /// the distance over which brightness rises or falls at strong edges, median (Marziliano et al. 2002). Motion blur
  /// widens the edges across it. NaN if there are fewer than 200 such edges.
  double edge_width_px = 0;
};

[[nodiscard]] ColorValues measure_color_values(const Image<Rgb8>& color);

}  // namespace resight
