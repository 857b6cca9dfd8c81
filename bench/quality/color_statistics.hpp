// SPDX-License-Identifier: Apache-2.0
// Noise, sharpness and colours of colour images, measured without knowing the scene.
#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "resight/core/image.hpp"

namespace resight {

class ColorStatistics {
 public:
  static constexpr int kPatch_px = 32;
  static constexpr std::size_t kNumBands = 4;

  void add(const Image<Rgb8>& color) {
    Image<float> luma(color.width(), color.height());
    for (std::size_t i = 0; i < color.size(); ++i) {
      const Rgb8 c = color[i];
      luma[i] = 0.299F * c.r + 0.587F * c.g + 0.114F * c.b;
      add_pixel(c, luma[i]);
    }
    add_flat_patches(luma);
    add_edges(luma);
  }

  /// Sigma within flat patches without their linear trend, grey levels.
  [[nodiscard]] double noise() const { return percentile(noise_, 0.5); }
  /// Share of that variance per octant of the frequencies up to half a cycle per pixel.
  [[nodiscard]] double band_share(std::size_t band) const {
    double total = 0;
    for (const double b : bands_) total += b;
    return bands_[band] / total;
  }
  /// Height beyond the plateau beside a step, as a share of the step.
  [[nodiscard]] double overshoot(double share) const { return percentile(overshoot_, share); }
  /// Width of a step from 10 to 90 %.
  [[nodiscard]] double rise_px() const { return percentile(rise_px_, 0.5); }
  [[nodiscard]] double brightness(double share) const {
    double left = share * num_pixels_;
    for (std::size_t i = 0; i < histogram_.size(); ++i)
      if ((left -= histogram_[i]) <= 0) return static_cast<double>(i);
    return 255;
  }
  [[nodiscard]] double clipped_share() const {
    double count = 0;
    for (std::size_t i = 250; i < 256; ++i) count += histogram_[i];
    return count / num_pixels_;
  }
  [[nodiscard]] double saturation(double share) const { return percentile(saturation_, share); }
  [[nodiscard]] double red_to_green() const { return sum_[0] / sum_[1]; }
  [[nodiscard]] double blue_to_green() const { return sum_[2] / sum_[1]; }

 private:
  static double percentile(std::vector<double> values, double share) {
    if (values.size() < 20) return std::nan("");
    const auto i = static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
    std::nth_element(values.begin(), values.begin() + i, values.end());
    return values[static_cast<std::size_t>(i)];
  }

  void add_pixel(Rgb8 c, float luma) {
    ++histogram_[static_cast<std::size_t>(std::clamp(luma + 0.5F, 0.0F, 255.0F))];
    num_pixels_ += 1;
    sum_[0] += c.r;
    sum_[1] += c.g;
    sum_[2] += c.b;
    const int high = std::max({c.r, c.g, c.b});
    const int low = std::min({c.r, c.g, c.b});
    if (luma > 30 && luma < 245 && ++saturation_step_ % 17 == 0)
      saturation_.push_back(static_cast<double>(high - low) / high);
  }

  struct Patch {
    double sigma = 0;
    int u0 = 0;
    int v0 = 0;
  };

  // Values without their linear trend.
  static std::vector<double> flattened(const Image<float>& luma, int u0, int v0) {
    const double middle = 0.5 * (kPatch_px - 1);
    double mean = 0, slope_u = 0, slope_v = 0, norm = 0;
    for (int v = 0; v < kPatch_px; ++v)
      for (int u = 0; u < kPatch_px; ++u) {
        const double x = luma(u0 + u, v0 + v);
        mean += x / (kPatch_px * kPatch_px);
        slope_u += x * (u - middle);
        slope_v += x * (v - middle);
        norm += (u - middle) * (u - middle);
      }
    std::vector<double> values;
    for (int v = 0; v < kPatch_px; ++v)
      for (int u = 0; u < kPatch_px; ++u)
        values.push_back(luma(u0 + u, v0 + v) - mean - slope_u / norm * (u - middle) - slope_v / norm * (v - middle));
    return values;
  }

  // The tenth of the patches that varies least, without those that are clipped.
  void add_flat_patches(const Image<float>& luma) {
    std::vector<Patch> patches;
    for (int v0 = 0; v0 + kPatch_px <= luma.height(); v0 += kPatch_px / 2)
      for (int u0 = 0; u0 + kPatch_px <= luma.width(); u0 += kPatch_px / 2) {
        const float middle = luma(u0 + kPatch_px / 2, v0 + kPatch_px / 2);
        if (middle < 20 || middle > 235) continue;
        double sum_sq = 0;
        for (const double x : flattened(luma, u0, v0)) sum_sq += x * x;
        patches.push_back({std::sqrt(sum_sq / (kPatch_px * kPatch_px)), u0, v0});
      }
    std::ranges::sort(patches, {}, &Patch::sigma);
    for (std::size_t i = 0; i < patches.size() / 10; ++i) {
      noise_.push_back(patches[i].sigma);
      add_spectrum(flattened(luma, patches[i].u0, patches[i].v0));
    }
  }

  // Power of the rows and columns of a patch by frequency.
  void add_spectrum(const std::vector<double>& values) {
    for (int line = 0; line < kPatch_px; ++line)
      for (int k = 1; k <= kPatch_px / 2; ++k)
        for (const bool is_row : {true, false}) {
          double re = 0, im = 0;
          for (int i = 0; i < kPatch_px; ++i) {
            const double x = values[static_cast<std::size_t>(is_row ? line * kPatch_px + i : i * kPatch_px + line)];
            const double phase = 2 * std::numbers::pi * k * i / kPatch_px;
            re += x * std::cos(phase);
            im += x * std::sin(phase);
          }
          const auto band = static_cast<std::size_t>((k - 1) * static_cast<int>(kNumBands) / (kPatch_px / 2));
          bands_[band] += re * re + im * im;
        }
  }

  // Steps along rows and columns with flat plateaus on both sides.
  void add_edges(const Image<float>& luma) {
    for (int v = 7; v + 7 < luma.height(); v += 2)
      for (int u = 7; u + 7 < luma.width(); ++u) add_edge([&](int i) { return luma(u + i, v); });
    for (int u = 7; u + 7 < luma.width(); u += 2)
      for (int v = 7; v + 7 < luma.height(); ++v) add_edge([&](int i) { return luma(u, v + i); });
  }

  template <typename Profile>
  void add_edge(const Profile& at) {
    const float step = at(1) - at(-1);
    if (std::abs(step) < 30 || std::abs(at(2) - at(0)) > std::abs(step) || std::abs(at(0) - at(-2)) > std::abs(step))
      return;  // not the steepest place
    const auto plateau = [&](int sign) { return (at(4 * sign) + at(5 * sign) + at(6 * sign) + at(7 * sign)) / 4; };
    const auto is_flat = [&](int sign, float level) {
      for (int i = 4; i <= 7; ++i)
        if (std::abs(at(i * sign) - level) > 8) return false;
      return true;
    };
    const float before = plateau(-1);
    const float after = plateau(1);
    const float height = after - before;
    if (std::abs(height) < 60 || height * step < 0 || !is_flat(-1, before) || !is_flat(1, after)) return;
    if (std::min(before, after) < 12 || std::max(before, after) > 240) return;  // clipped
    float beyond = -1;
    for (int i = 1; i <= 3; ++i) beyond = std::max({beyond, (at(i) - after) / height, (before - at(-i)) / height});
    overshoot_.push_back(beyond);
    rise_px_.push_back(rise_width([&](int i) { return (at(i) - before) / height; }));
  }

  template <typename Profile>
  static double rise_width(const Profile& share_at) {
    const auto crossing = [&](float level) {
      for (int i = -4; i < 4; ++i) {
        const float a = share_at(i);
        const float b = share_at(i + 1);
        if (a < level && b >= level) return static_cast<double>(i) + (level - a) / (b - a);
      }
      return 4.0;
    };
    return crossing(0.9F) - crossing(0.1F);
  }

  std::vector<double> noise_, overshoot_, rise_px_, saturation_;
  std::array<double, kNumBands> bands_{};
  std::array<double, 256> histogram_{};
  std::array<double, 3> sum_{};
  double num_pixels_ = 0;
  int saturation_step_ = 0;
};

}  // namespace resight
