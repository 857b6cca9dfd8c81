// SPDX-License-Identifier: Apache-2.0
#include "resight/inspection/color_depth_shift.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "resight/inspection/internal/contour_contrast.hpp"

namespace resight {
namespace {

constexpr int kMinContour_px = 200;
constexpr double kScaleSigmas = 0.5;  // By which a peak at another scale must be higher.
constexpr double kMinPeakSigmas = 5;  // Of an unregistered shift.
constexpr double kSameShift_px = 4;   // Of both halves of the views.
constexpr double kSameScale = 0.06;

/// With a border of zeros, so that every shift has a value.
Image<float> add_border(const Image<float>& contrast) {
  constexpr int kBorder = ShiftScores::kReach_px;
  Image<float> wide(contrast.width() + 2 * kBorder, contrast.height() + 2 * kBorder);
  for (int v = 0; v < contrast.height(); ++v)
    for (int u = 0; u < contrast.width(); ++u) wide(u + kBorder, v + kBorder) = contrast(u, v);
  return wide;
}

}  // namespace

ShiftScores::ShiftScores() {
  for (std::vector<float>& sums : sums_) sums.resize(static_cast<std::size_t>(kNumShifts) * kNumShifts);
}

void ShiftScores::add(const PreparedView& view) {
  const Image<float> along_row = add_border(inspection::find_contrast(view.frame.color, true));
  const Image<float> along_column = add_border(inspection::find_contrast(view.frame.color, false));
  const double middle_u = 0.5 * (view.frame.color.width() - 1);
  const double middle_v = 0.5 * (view.frame.color.height() - 1);
  for (const inspection::ContourPixel& pixel : inspection::find_contour_pixels(view)) {
    ++num_pixels_;
    for (std::size_t s = 0; s < kScales.size(); ++s) {
      const int u = static_cast<int>(std::lround(middle_u + kScales[s] * (pixel.u - middle_u)));
      const int v = static_cast<int>(std::lround(middle_v + kScales[s] * (pixel.v - middle_v)));
      if (!view.frame.color.contains(u, v)) continue;  // of a scale above 1
      float* sum = sums_[s].data();
      for (int y = 0; y < kNumShifts; ++y) {
        const float* row = &(pixel.along_row ? along_row : along_column)(u, v + y);
        for (int x = 0; x < kNumShifts; ++x) *sum++ += row[x];
      }
    }
  }
}

void ShiftScores::add(const ShiftScores& other) {
  for (std::size_t s = 0; s < sums_.size(); ++s)
    for (std::size_t i = 0; i < sums_[s].size(); ++i) sums_[s][i] += other.sums_[s][i];
  num_pixels_ += other.num_pixels_;
}

std::optional<ColorDepthShift> ShiftScores::peak() const {
  if (num_pixels_ < kMinContour_px) return std::nullopt;
  ColorDepthShift best;
  double best_score = 0;
  for (std::size_t s = 0; s < sums_.size(); ++s) {
    double sum = 0, sum_sq = 0;
    for (const float score : sums_[s]) {
      sum += score;
      sum_sq += static_cast<double>(score) * score;
    }
    const auto num = static_cast<double>(sums_[s].size());
    const double sigma = std::sqrt(std::max(0.0, sum_sq / num - sum / num * sum / num));
    const auto at = std::ranges::max_element(sums_[s]);
    const double sigmas = sigma > 0 ? (static_cast<double>(*at) - sum / num) / sigma : 0;
    // Few contours do not tell scales apart: no scale is the rule.
    const double score = sigmas - (kScales[s] == 1 ? 0 : kScaleSigmas);
    if (score <= best_score) continue;
    best_score = score;
    const auto index = static_cast<int>(at - sums_[s].begin());
    best.shift_px = {index % kNumShifts - kReach_px, index / kNumShifts - kReach_px};
    best.scale = kScales[s];
    best.peak_sigmas = sigmas;
    best.mean_contrast = static_cast<double>(*at) / num_pixels_;
  }
  return best;
}

std::optional<ColorDepthShift> find_unregistered_shift(const std::array<ShiftScores, 2>& half_shifts,
                                                       double max_registered_px) {
  const auto a = half_shifts[0].peak();
  const auto b = half_shifts[1].peak();
  if (!a || !b) return std::nullopt;
  const double difference_px = (a->shift_px - b->shift_px).norm();  // Half of it is the error of their mean.
  const auto is_wide = [&](const ColorDepthShift& s) {
    return s.shift_px.norm() > max_registered_px + 0.5 * difference_px || std::abs(s.scale - 1) > kMaxRegisteredScale;
  };
  if (!is_wide(*a) || !is_wide(*b) || std::min(a->peak_sigmas, b->peak_sigmas) < kMinPeakSigmas ||
      std::abs(a->scale - b->scale) > kSameScale || difference_px > kSameShift_px)
    return std::nullopt;
  return a;
}

void align_colors(const ColorDepthShift& shift, RgbdFrame& frame) {
  const Image<Rgb8> seen = std::exchange(frame.color, Image<Rgb8>(frame.color.width(), frame.color.height()));
  const Eigen::Vector2d middle(0.5 * (seen.width() - 1), 0.5 * (seen.height() - 1));
  for (int v = 0; v < seen.height(); ++v)
    for (int u = 0; u < seen.width(); ++u) {
      const Eigen::Vector2d at = middle + shift.scale * (Eigen::Vector2d(u, v) - middle) + shift.shift_px;
      const auto x = static_cast<int>(std::lround(at.x()));
      const auto y = static_cast<int>(std::lround(at.y()));
      if (seen.contains(x, y))
        frame.color(u, v) = seen(x, y);
      else
        frame.depth_m(u, v) = std::numeric_limits<float>::quiet_NaN();
    }
}

}  // namespace resight
