// SPDX-License-Identifier: Apache-2.0
#include "resight/sensor/surface_color.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <numeric>

#include "resight/core/check.hpp"
#include "resight/core/parallel.hpp"
#include "resight/core/statistics.hpp"
#include "resight/geometry/area_sums.hpp"

namespace resight {
namespace {

constexpr std::size_t kAveragedRowsPerTask = 16;
constexpr double kUsualNoise = 1;  // Grey levels: what cameras leave after their own noise reduction.
constexpr int kCutOff = 8;         // Grey levels from black and from white.
constexpr double kGain = 6;        // Root of the sum of the operator's squared weights.

using ColorSum = Eigen::Array<std::uint32_t, 3, 1>;  // Per channel. Enough for the largest images (kMaxViewPixels).
using ColorSums = AreaSums<ColorSum>;
using ResponseCounts = std::array<int, 16 * 255 + 1>;  // By absolute response to the operator.

Rgb8 mean_around(const ColorSums& sums, const Image<Rgb8>& color, int u, int v, int radius_px) {
  const int left = std::max(u - radius_px, 0);
  const int top = std::max(v - radius_px, 0);
  const int right = std::min(u + radius_px, color.width() - 1);
  const int bottom = std::min(v + radius_px, color.height() - 1);
  const auto area = static_cast<std::uint32_t>((right - left + 1) * (bottom - top + 1));
  const ColorSum mean = (sums.sum(left, top, right, bottom) + area / 2) / area;
  return {static_cast<std::uint8_t>(mean[0]), static_cast<std::uint8_t>(mean[1]), static_cast<std::uint8_t>(mean[2])};
}

// Absolute responses of one channel to Immerkaer's operator, in which edges and slopes cancel. Nearly black and nearly
// white pixels have no noise, because it is cut off.
void add_responses(const Image<Rgb8>& color, std::uint8_t Rgb8::*channel, ResponseCounts& counts) {
  constexpr int kStep = 2;  // A quarter of the pixels is enough.
  for (int v = 1; v + 1 < color.height(); v += kStep)
    for (int u = 1; u + 1 < color.width(); u += kStep) {
      const auto at = [&](int du, int dv) { return static_cast<int>(color(u + du, v + dv).*channel); };
      if (at(0, 0) <= kCutOff || at(0, 0) >= 255 - kCutOff) continue;
      const int corners = at(-1, -1) + at(1, -1) + at(-1, 1) + at(1, 1);
      const int sides = at(0, -1) + at(-1, 0) + at(1, 0) + at(0, 1);
      ++counts[static_cast<std::size_t>(std::abs(corners - 2 * sides + 4 * at(0, 0)))];
    }
}

}  // namespace

double estimate_image_noise(const Image<Rgb8>& color) {
  ResponseCounts counts{};
  for (const auto channel : {&Rgb8::r, &Rgb8::g, &Rgb8::b}) add_responses(color, channel, counts);
  const int num_responses = std::accumulate(counts.begin(), counts.end(), 0);
  if (num_responses == 0) return 0;
  int below = 0;
  std::size_t median = 0;
  while (below + counts[median] <= num_responses / 2) below += counts[median++];
  return kNormalizedMad * static_cast<double>(median) / kGain;
}

Image<Rgb8> average_over_surface(const Image<Rgb8>& color, const Camera& camera, const Image<float>& z_m,
                                 double width_m, int num_threads) {
  check_positive("average_over_surface: width_m", width_m);
  require(color.width() == camera.width && color.height() == camera.height && z_m.width() == camera.width &&
              z_m.height() == camera.height,
          "average_over_surface: the images do not have the size of the camera");
  const double noise = estimate_image_noise(color);
  if (!(noise > kUsualNoise)) return {};
  // The mean over a square of n x n pixels has an n-th of the noise.
  const int max_radius_px = static_cast<int>(std::ceil((noise / kUsualNoise - 1) / 2));
  const ColorSums sums(color.width(), color.height(), [&](int u, int v) {
    const Rgb8 c = color(u, v);
    return ColorSum(c.r, c.g, c.b);
  });
  const auto half_width_px_m = static_cast<float>(0.5 * width_m * camera.fx);
  Image<Rgb8> averaged = color;
  parallel_for_blocks(static_cast<std::size_t>(color.height()), kAveragedRowsPerTask, num_threads,
                      [&](std::size_t begin, std::size_t end) {
                        for (int v = static_cast<int>(begin); v < static_cast<int>(end); ++v)
                          for (int u = 0; u < color.width(); ++u) {
                            const float radius_px = half_width_px_m / z_m(u, v);
                            if (!(radius_px >= 1)) continue;  // NaN: no depth.
                            averaged(u, v) = mean_around(
                                sums, color, u, v,
                                static_cast<int>(std::min<float>(radius_px, static_cast<float>(max_radius_px))));
                          }
                      });
  return averaged;
}

}  // namespace resight
