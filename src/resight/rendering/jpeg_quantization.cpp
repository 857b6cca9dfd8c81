// SPDX-License-Identifier: Apache-2.0
#include "resight/rendering/internal/jpeg_quantization.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "resight/core/parallel.hpp"

namespace resight {
namespace {

constexpr int kSide = 8;
using Block = Eigen::Matrix<float, kSide, kSide, Eigen::RowMajor>;

constexpr std::array<int, 64> kLuma{16, 11, 10, 16, 24,  40,  51,  61,  12, 12, 14, 19, 26,  58,  60,  55,
                                    14, 13, 16, 24, 40,  57,  69,  56,  14, 17, 22, 29, 51,  87,  80,  62,
                                    18, 22, 37, 56, 68,  109, 103, 77,  24, 35, 55, 64, 81,  104, 113, 92,
                                    49, 64, 78, 87, 103, 121, 120, 101, 72, 92, 95, 98, 112, 100, 103, 99};
constexpr std::array<int, 64> kChroma{17, 18, 24, 47, 99, 99, 99, 99, 18, 21, 26, 66, 99, 99, 99, 99,
                                      24, 26, 56, 99, 99, 99, 99, 99, 47, 66, 99, 99, 99, 99, 99, 99,
                                      99, 99, 99, 99, 99, 99, 99, 99, 99, 99, 99, 99, 99, 99, 99, 99,
                                      99, 99, 99, 99, 99, 99, 99, 99, 99, 99, 99, 99, 99, 99, 99, 99};

Block scaled_table(const std::array<int, 64>& table, int quality) {
  const int scale = quality < 50 ? 5000 / quality : 200 - 2 * quality;
  Block steps;
  for (int i = 0; i < 64; ++i)
    steps(i / kSide, i % kSide) = static_cast<float>(std::clamp((table[i] * scale + 50) / 100, 1, 255));
  return steps;
}

Block cosine_basis() {
  Block basis;
  for (int k = 0; k < kSide; ++k)
    for (int x = 0; x < kSide; ++x)
      basis(k, x) = static_cast<float>(std::sqrt((k == 0 ? 1.0 : 2.0) / kSide) *
                                       std::cos(std::numbers::pi * k * (2 * x + 1) / (2 * kSide)));
  return basis;
}

// Blocks that reach beyond the image repeat its last pixels, as encoders do.
void quantize_plane(Image<float>& plane, const Block& steps, int num_threads) {
  const Block basis = cosine_basis();
  const int rows = (plane.height() + kSide - 1) / kSide;
  parallel_for(static_cast<std::size_t>(rows), num_threads, [&](std::size_t row) {
    const int v0 = static_cast<int>(row) * kSide;
    for (int u0 = 0; u0 < plane.width(); u0 += kSide) {
      Block block;
      for (int y = 0; y < kSide; ++y)
        for (int x = 0; x < kSide; ++x)
          block(y, x) = plane(std::min(u0 + x, plane.width() - 1), std::min(v0 + y, plane.height() - 1)) - 128;
      Block spectrum = basis * block * basis.transpose();
      spectrum = (spectrum.array() / steps.array()).round() * steps.array();
      block = basis.transpose() * spectrum * basis;
      for (int y = 0; y < kSide && v0 + y < plane.height(); ++y)
        for (int x = 0; x < kSide && u0 + x < plane.width(); ++x) plane(u0 + x, v0 + y) = block(y, x) + 128;
    }
  });
}

float mean_of_four(const Image<float>& image, int u, int v) {
  const int u1 = std::min(u + 1, image.width() - 1);
  const int v1 = std::min(v + 1, image.height() - 1);
  return 0.25F * (image(u, v) + image(u1, v) + image(u, v1) + image(u1, v1));
}

Image<float> halve(const Image<float>& image) {
  Image<float> half((image.width() + 1) / 2, (image.height() + 1) / 2);
  for (int v = 0; v < half.height(); ++v)
    for (int u = 0; u < half.width(); ++u) half(u, v) = mean_of_four(image, 2 * u, 2 * v);
  return half;
}

// Value at a pixel of the full image, interpolated between the centres of the pixels of the half image.
float double_at(const Image<float>& half, int u, int v) {
  const float x = 0.5F * static_cast<float>(u) - 0.25F;
  const float y = 0.5F * static_cast<float>(v) - 0.25F;
  const int x0 = static_cast<int>(std::floor(x));
  const int y0 = static_cast<int>(std::floor(y));
  const float ax = x - static_cast<float>(x0);
  const float ay = y - static_cast<float>(y0);
  const auto at = [&](int a, int b) {
    return half(std::clamp(a, 0, half.width() - 1), std::clamp(b, 0, half.height() - 1));
  };
  return (1 - ay) * ((1 - ax) * at(x0, y0) + ax * at(x0 + 1, y0)) +
         ay * ((1 - ax) * at(x0, y0 + 1) + ax * at(x0 + 1, y0 + 1));
}

}  // namespace

void quantize_as_jpeg(Image<Eigen::Vector3f>& rgb, int quality, int num_threads) {
  const int w = rgb.width();
  const int h = rgb.height();
  Image<float> luma(w, h), blue(w, h), red(w, h);
  for (std::size_t i = 0; i < rgb.size(); ++i) {
    const Eigen::Vector3f& c = rgb[i];
    luma[i] = 0.299F * c.x() + 0.587F * c.y() + 0.114F * c.z();
    blue[i] = 128 + 0.564F * (c.z() - luma[i]);
    red[i] = 128 + 0.713F * (c.x() - luma[i]);
  }
  Image<float> half_blue = halve(blue);
  Image<float> half_red = halve(red);
  quantize_plane(luma, scaled_table(kLuma, quality), num_threads);
  quantize_plane(half_blue, scaled_table(kChroma, quality), num_threads);
  quantize_plane(half_red, scaled_table(kChroma, quality), num_threads);
  parallel_for(static_cast<std::size_t>(h), num_threads, [&](std::size_t row) {
    const int v = static_cast<int>(row);
    for (int u = 0; u < w; ++u) {
      const float y = luma(u, v);
      const float b = double_at(half_blue, u, v) - 128;
      const float r = double_at(half_red, u, v) - 128;
      rgb(u, v) = {y + 1.402F * r, y - 0.344F * b - 0.714F * r, y + 1.772F * b};
    }
  });
}

}  // namespace resight
