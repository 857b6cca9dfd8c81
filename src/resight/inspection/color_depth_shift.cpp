// SPDX-License-Identifier: Apache-2.0
#include "resight/inspection/color_depth_shift.hpp"

#include <algorithm>
#include <cmath>

#include "resight/inspection/internal/contour_contrast.hpp"

namespace resight {
namespace {

constexpr int kMinContour_px = 200;
constexpr double kScaleSigmas = 0.5;  // By which a peak at another scale must be higher.

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
  best.num_contour_pixels = num_pixels_;
  return best;
}

}  // namespace resight
