// SPDX-License-Identifier: Apache-2.0
#include "resight/inspection/internal/contour_contrast.hpp"

#include <algorithm>
#include <cmath>

#include "resight/sensor/occluding_contour.hpp"

namespace resight::inspection {
namespace {

constexpr std::size_t kMaxContour_px = 1000;
constexpr float kMaxEdgeContrast = 40;  // Grey levels; stronger edges count no more.

float grey_at(const Image<Rgb8>& color, int u, int v) {
  const Rgb8& c = color(std::clamp(u, 0, color.width() - 1), std::clamp(v, 0, color.height() - 1));
  return static_cast<float>(c.r + c.g + c.b) / 3;
}

}  // namespace

std::vector<ContourPixel> find_contour_pixels(const PreparedView& view) {
  std::vector<ContourPixel> all;
  const Image<float>& depth_m = view.frame.depth_m;
  for (int v = 0; v < depth_m.height(); ++v)
    for (int u = 0; u < depth_m.width(); ++u) {
      if (view.edge_distance_px(u, v) > 0 || std::isnan(depth_m(u, v))) continue;
      for (const PixelStep step : kPixelSteps)
        if (is_occluding_contour(depth_m, u, v, step)) all.push_back({u, v, depth_m(u, v), step.u != 0});
    }
  const std::size_t step = all.size() / kMaxContour_px + 1;
  std::vector<ContourPixel> some;
  for (std::size_t i = 0; i < all.size(); i += step) some.push_back(all[i]);
  return some;
}

Image<float> find_contrast(const Image<Rgb8>& color, bool along_row) {
  const int du = along_row ? 1 : 0;
  const int dv = along_row ? 0 : 1;
  Image<float> contrast(color.width(), color.height());
  for (int v = 0; v < color.height(); ++v)
    for (int u = 0; u < color.width(); ++u)
      contrast(u, v) =
          std::min(std::abs(grey_at(color, u + du, v + dv) - grey_at(color, u - du, v - dv)), kMaxEdgeContrast);
  return contrast;
}

}  // namespace resight::inspection
