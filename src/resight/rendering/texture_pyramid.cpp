// SPDX-License-Identifier: Apache-2.0
#include "resight/rendering/internal/texture_pyramid.hpp"

#include <algorithm>
#include <cmath>

namespace resight {
namespace {

Image<Rgb8> halve(const Image<Rgb8>& image) {
  const int w = std::max(1, image.width() / 2);
  const int h = std::max(1, image.height() / 2);
  Image<Rgb8> half(w, h);
  for (int v = 0; v < h; ++v)
    for (int u = 0; u < w; ++u) {
      const int u1 = std::min(2 * u + 1, image.width() - 1);
      const int v1 = std::min(2 * v + 1, image.height() - 1);
      const Rgb8 a = image(2 * u, 2 * v), b = image(u1, 2 * v), c = image(2 * u, v1), d = image(u1, v1);
      const auto mean = [](int p, int q, int r, int s) { return static_cast<std::uint8_t>((p + q + r + s + 2) / 4); };
      half(u, v) = {mean(a.r, b.r, c.r, d.r), mean(a.g, b.g, c.g, d.g), mean(a.b, b.b, c.b, d.b)};
    }
  return half;
}

Eigen::Vector3f bilinear(const Image<Rgb8>& image, const Eigen::Vector2f& uv) {
  const int w = image.width();
  const int h = image.height();
  const float x = (uv.x() - std::floor(uv.x())) * static_cast<float>(w) - 0.5F;
  const float y = (uv.y() - std::floor(uv.y())) * static_cast<float>(h) - 0.5F;
  const int x0 = static_cast<int>(std::floor(x));
  const int y0 = static_cast<int>(std::floor(y));
  const float ax = x - static_cast<float>(x0);
  const float ay = y - static_cast<float>(y0);
  const auto at = [&](int u, int v) {
    const Rgb8 c = image(std::clamp(u, 0, w - 1), std::clamp(v, 0, h - 1));
    return Eigen::Vector3f(c.r, c.g, c.b);
  };
  return (1 - ay) * ((1 - ax) * at(x0, y0) + ax * at(x0 + 1, y0)) +
         ay * ((1 - ax) * at(x0, y0 + 1) + ax * at(x0 + 1, y0 + 1));
}

}  // namespace

TexturePyramid::TexturePyramid(const Image<Rgb8>& texture) {
  if (texture.empty()) return;
  levels_.push_back(texture);
  while (std::min(levels_.back().width(), levels_.back().height()) > 4) levels_.push_back(halve(levels_.back()));
}

Eigen::Vector3f TexturePyramid::sample(const Eigen::Vector2f& uv, float level) const {
  if (!(level > 0)) return bilinear(levels_.front(), uv);
  const float last = static_cast<float>(levels_.size() - 1);
  const float clamped = std::min(level, last);
  const auto lower = static_cast<std::size_t>(clamped);
  const float share = clamped - static_cast<float>(lower);
  const Eigen::Vector3f fine = bilinear(levels_[lower], uv);
  if (share == 0) return fine;
  return (1 - share) * fine + share * bilinear(levels_[lower + 1], uv);
}

}  // namespace resight
