// SPDX-License-Identifier: Apache-2.0
#include "resight/sensor/reduce_frame.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "resight/core/check.hpp"

namespace resight {
namespace {

Rgb8 mean_color(const Image<Rgb8>& color, int left, int top, int divisor) {
  int r = 0;
  int g = 0;
  int b = 0;
  for (int v = top; v < top + divisor; ++v)
    for (int u = left; u < left + divisor; ++u) {
      r += color(u, v).r;
      g += color(u, v).g;
      b += color(u, v).b;
    }
  const int n = divisor * divisor;
  const auto rounded = [n](int sum) { return static_cast<std::uint8_t>((sum + n / 2) / n); };
  return {rounded(r), rounded(g), rounded(b)};
}

/// `measured`: memory for the depths of a block.
float median_depth(const Image<float>& depth_m, int left, int top, int divisor, std::vector<float>& measured) {
  measured.clear();
  for (int v = top; v < top + divisor; ++v)
    for (int u = left; u < left + divisor; ++u)
      if (!std::isnan(depth_m(u, v))) measured.push_back(depth_m(u, v));
  if (2 * static_cast<int>(measured.size()) < divisor * divisor) return std::numeric_limits<float>::quiet_NaN();
  const auto middle = measured.begin() + static_cast<std::ptrdiff_t>((measured.size() - 1) / 2);
  std::nth_element(measured.begin(), middle, measured.end());
  return *middle;
}

}  // namespace

int find_reduction(const Camera& camera, int max_pixels) {
  require(max_pixels >= 1, "find_reduction: max_pixels must be at least 1");
  const auto count = [&](int divisor) {
    return static_cast<std::int64_t>(camera.width / divisor) * (camera.height / divisor);
  };
  const int largest = std::max(1, std::min(camera.width, camera.height));
  int divisor = 1;
  while (divisor < largest && count(divisor) > max_pixels) ++divisor;
  return divisor;
}

Camera reduce_camera(const Camera& camera, int divisor) {
  // The centre of the first block is at pixel (divisor - 1) / 2.
  const double shift = 0.5 * (divisor - 1);
  return {camera.width / divisor,        camera.height / divisor,       camera.fx / divisor, camera.fy / divisor,
          (camera.cx - shift) / divisor, (camera.cy - shift) / divisor, camera.noise};
}

RgbdFrame reduce_frame(const RgbdFrame& frame, int divisor) {
  require(divisor >= 1 && divisor <= frame.camera.width && divisor <= frame.camera.height,
          "reduce_frame: divisor must be from 1 to the width and height of the frame");
  RgbdFrame reduced{frame.name, reduce_camera(frame.camera, divisor), {}, {}, frame.world_from_camera};
  reduced.color = Image<Rgb8>(reduced.camera.width, reduced.camera.height);
  reduced.depth_m = Image<float>(reduced.camera.width, reduced.camera.height);
  std::vector<float> measured;
  for (int v = 0; v < reduced.camera.height; ++v)
    for (int u = 0; u < reduced.camera.width; ++u) {
      reduced.color(u, v) = mean_color(frame.color, u * divisor, v * divisor, divisor);
      reduced.depth_m(u, v) = median_depth(frame.depth_m, u * divisor, v * divisor, divisor, measured);
    }
  return reduced;
}

Image<std::uint8_t> enlarge_mask(const Image<std::uint8_t>& reduced, int divisor, int width, int height) {
  require(divisor >= 1 && divisor * reduced.width() <= width && divisor * reduced.height() <= height,
          "enlarge_mask: the mask is not of a frame of this size");
  Image<std::uint8_t> enlarged(width, height, 0);
  for (int v = 0; v < divisor * reduced.height(); ++v)
    for (int u = 0; u < divisor * reduced.width(); ++u) enlarged(u, v) = reduced(u / divisor, v / divisor);
  return enlarged;
}

Result<RgbdFrame> read_reduced_view(const Sequence& sequence, int view, int max_pixels) {
  Result<RgbdFrame> frame = sequence.read_view(view);
  if (!frame) return frame;
  const int divisor = find_reduction(frame->camera, max_pixels);
  return divisor > 1 ? Result<RgbdFrame>(reduce_frame(*frame, divisor)) : std::move(frame);
}

}  // namespace resight
