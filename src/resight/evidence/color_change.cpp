// SPDX-License-Identifier: Apache-2.0
#include "resight/evidence/color_change.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include "resight/core/check.hpp"
#include "resight/core/statistics.hpp"
#include "resight/geometry/area_sums.hpp"

namespace resight {
namespace {

constexpr int kSurroundingsPerWidth = 32;  // 20 px of 640: some 4 cm at 1 m.
constexpr int kSampleStep_px = 16;         // One pixel in 256 is enough for a median.
constexpr double kMinSimilarShare = 0.1;   // Alike things lie on each other more often than far apart.
constexpr float kMaxGain = 4;              // Beyond, one of the images is black.
constexpr float kMinContrast = 32;         // In grey levels: light on uneven surfaces causes less.
constexpr float kMedians = 3;              // Noise of three channels exceeds 2.6 medians in one pixel of a thousand.

using Channels = Eigen::Array3f;

Channels channels_of(Rgb8 color) { return {float(color.r), float(color.g), float(color.b)}; }

/// The factor per channel by which the exposure differs: a median over the image.
Channels estimate_gain(const Image<Rgb8>& colors, const Image<Rgb8>& others, const Image<int>& pixels) {
  std::array<std::vector<float>, 3> ratios;
  for (int v = 0; v < pixels.height(); v += kSampleStep_px)
    for (int u = 0; u < pixels.width(); u += kSampleStep_px) {
      if (pixels(u, v) < 0) continue;
      const Channels other = channels_of(others[static_cast<std::size_t>(pixels(u, v))]);
      const Channels ratio = (channels_of(colors(u, v)) + 1) / (other + 1);  // Of black pixels, too.
      for (int c = 0; c < 3; ++c) ratios[static_cast<std::size_t>(c)].push_back(ratio[c]);
    }
  Channels gain = Channels::Ones();
  for (int c = 0; c < 3; ++c)
    if (auto& of_channel = ratios[static_cast<std::size_t>(c)]; !of_channel.empty())
      gain[c] = std::clamp(upper_median(std::move(of_channel)), 1 / kMaxGain, kMaxGain);
  return gain;
}

/// Means of the differences of colours over squares, from one pixel in four.
class MeanDifferences {
  using Sums = Eigen::Matrix<std::int64_t, 4, 1>;  // Three channels, and the number of pixels.

 public:
  MeanDifferences(const Image<Rgb8>& colors, const Image<Rgb8>& others, const Image<int>& pixels, const Channels& gain)
      : sums_((colors.width() + kStep_px - 1) / kStep_px, (colors.height() + kStep_px - 1) / kStep_px,
              [&](int u, int v) -> Sums {
                const std::size_t i = colors.index(u * kStep_px, v * kStep_px);
                if (pixels[i] < 0) return Sums::Zero();
                const Channels d =
                    channels_of(colors[i]) - gain * channels_of(others[static_cast<std::size_t>(pixels[i])]);
                Sums value = Sums::Ones();
                value.head<3>() = d.max(-kMaxLevel).min(kMaxLevel).cast<std::int64_t>().matrix();
                return value;
              }) {}

  /// Over the square around a pixel; zero without any pair of colours in it.
  [[nodiscard]] Channels mean(int u, int v, int radius_px) const {
    const Sums sum = sums_.sum(std::max(u - radius_px, 0) / kStep_px, std::max(v - radius_px, 0) / kStep_px,
                               (u + radius_px) / kStep_px, (v + radius_px) / kStep_px);
    return sum.head<3>().cast<float>().array() / static_cast<float>(std::max<std::int64_t>(sum[3], 1));
  }

 private:
  static constexpr int kStep_px = 2;
  static constexpr float kMaxLevel = 255;

  AreaSums<Sums> sums_;
};

class ColorComparison {
 public:
  ColorComparison(const PreparedView& surfaces, const PreparedView& view, const Image<int>& view_pixels, int radius_px)
      : colors_(surfaces.surface_color()),
        others_(view.surface_color()),
        pixels_(view_pixels),
        radius_px_(radius_px),
        gain_(estimate_gain(colors_, others_, view_pixels)),
        means_(colors_, others_, view_pixels, gain_) {}

  /// Grey levels between the colour and the most similar one in the other view. What is at most `enough` may be
  /// returned too large. The pixel must have one in the other view.
  [[nodiscard]] float difference(int u, int v, float enough) const {
    const Channels color = channels_of(colors_(u, v));
    return least_difference(pixels_(u, v), enough,
                            [&](const Channels& other) { return (color - other).square().sum(); });
  }

  /// Same, as they are or after the mean difference around the pixel is taken off, whichever is less. Without the
  /// first, what lies beside a change would seem changed.
  [[nodiscard]] float deviation(int u, int v, float enough) const {
    const Channels color = channels_of(colors_(u, v));
    const Channels even = color - means_.mean(u, v, pixels_.width() / kSurroundingsPerWidth);
    return least_difference(pixels_(u, v), enough, [&](const Channels& other) {
      return std::min((color - other).square().sum(), (even - other).square().sum());
    });
  }

  /// Share of pixels whose colour in the other view, a third of the image away, differs by no more than `limit`.
  [[nodiscard]] double similar_share(float limit) const {
    int num = 0;
    int num_similar = 0;
    for (int v = 0; v < pixels_.height(); v += kSampleStep_px)
      for (int u = 0; u < pixels_.width(); u += kSampleStep_px) {
        const int far_u = (u + pixels_.width() / 3) % pixels_.width();
        const int far_v = (v + pixels_.height() / 3) % pixels_.height();
        if (pixels_(far_u, far_v) < 0) continue;
        ++num;
        const Channels other = gain_ * channels_of(others_[static_cast<std::size_t>(pixels_(far_u, far_v))]);
        num_similar += (channels_of(colors_(u, v)) - other).square().sum() <= limit * limit ? 1 : 0;
      }
    return num == 0 ? 1 : std::max(kMinSimilarShare, static_cast<double>(num_similar) / num);
  }

  /// The limit of difference() and of deviation().
  [[nodiscard]] float find_limit() const {
    std::vector<float> sample;
    for (int v = 0; v < pixels_.height(); v += kSampleStep_px)
      for (int u = 0; u < pixels_.width(); u += kSampleStep_px)
        if (pixels_(u, v) >= 0) sample.push_back(deviation(u, v, 0));
    return kMinContrast + (sample.empty() ? 0 : kMedians * upper_median(std::move(sample)));
  }

 private:
  /// The square root of the least `squared` difference of the pixels around `center` of the other view.
  template <typename Squared>
  [[nodiscard]] float least_difference(int center, float enough, const Squared& squared) const {
    const auto at = [&](std::size_t other) { return squared(gain_ * channels_of(others_[other])); };
    float least = at(static_cast<std::size_t>(center));
    const int center_u = center % others_.width();
    const int center_v = center / others_.width();
    for (int y = std::max(center_v - radius_px_, 0); y <= std::min(center_v + radius_px_, others_.height() - 1); ++y)
      for (int x = std::max(center_u - radius_px_, 0); x <= std::min(center_u + radius_px_, others_.width() - 1); ++x) {
        if (least <= enough * enough) return std::sqrt(least);
        least = std::min(least, at(others_.index(x, y)));
      }
    return std::sqrt(least);
  }

  const Image<Rgb8>& colors_;
  const Image<Rgb8>& others_;
  const Image<int>& pixels_;
  int radius_px_;
  Channels gain_;
  MeanDifferences means_;
};

}  // namespace

ColorChanges find_color_changes(const PreparedView& surfaces, const PreparedView& view, const Image<int>& view_pixels,
                                std::span<const int> candidates, int radius_px) {
  require(view_pixels.size() == surfaces.cloud.z.size(), "find_color_changes: the pixels are not those of the view");
  ColorChanges found;
  if (surfaces.surface_color().size() != view_pixels.size() || view.surface_color().size() != view.cloud.z.size())
    return found;
  const ColorComparison comparison(surfaces, view, view_pixels, radius_px);
  const float limit = comparison.find_limit();
  found.similar_share = comparison.similar_share(limit / 2);
  for (const int i : candidates) {
    if (view_pixels[static_cast<std::size_t>(i)] < 0) continue;
    const int u = i % view_pixels.width();
    const int v = i / view_pixels.width();
    const float difference = comparison.difference(u, v, limit / 2);
    if (difference <= limit / 2)
      found.same.push_back(i);
    else if (difference > limit)
      (comparison.deviation(u, v, limit) > limit ? found.standing_out : found.different).push_back(i);
  }
  return found;
}

}  // namespace resight
