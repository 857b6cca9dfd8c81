// SPDX-License-Identifier: Apache-2.0
#include "resight/inspection/color_depth_shift.hpp"

#include <algorithm>
#include <cmath>

#include "resight/sensor/occluding_contour.hpp"

namespace resight {
namespace {

constexpr int kMinContour_px = 200;
constexpr double kScaleSigmas = 0.5;          // By which a peak at another scale must be higher.
constexpr std::size_t kMaxContour_px = 1000;  // Per view.
constexpr float kMaxEdgeContrast = 40;        // Grey levels; stronger edges count no more.

float grey_at(const Image<Rgb8>& color, int u, int v) {
  const Rgb8& c = color(std::clamp(u, 0, color.width() - 1), std::clamp(v, 0, color.height() - 1));
  return static_cast<float>(c.r + c.g + c.b) / 3;
}

/// Contrast over three pixels along rows (or columns), with a border of zeros: depth ends within a pixel or two of the
/// contour.
Image<float> find_contrast(const Image<Rgb8>& color, int du, int dv) {
  constexpr int kBorder = ShiftScores::kReach_px;
  Image<float> contrast(color.width() + 2 * kBorder, color.height() + 2 * kBorder);
  for (int v = 0; v < color.height(); ++v)
    for (int u = 0; u < color.width(); ++u)
      contrast(u + kBorder, v + kBorder) =
          std::min(std::abs(grey_at(color, u + du, v + dv) - grey_at(color, u - du, v - dv)), kMaxEdgeContrast);
  return contrast;
}

struct ContourPixel {
  int u, v;
  bool along_row;
};

std::vector<ContourPixel> find_contour_pixels(const PreparedView& view) {
  std::vector<ContourPixel> all;
  const Image<float>& depth_m = view.frame.depth_m;
  for (int v = 0; v < depth_m.height(); ++v)
    for (int u = 0; u < depth_m.width(); ++u) {
      if (view.edge_distance_px(u, v) > 0 || std::isnan(depth_m(u, v))) continue;
      for (const PixelStep step : kPixelSteps)
        if (is_occluding_contour(depth_m, u, v, step)) all.push_back({u, v, step.u != 0});
    }
  const std::size_t step = all.size() / kMaxContour_px + 1;
  std::vector<ContourPixel> some;
  for (std::size_t i = 0; i < all.size(); i += step) some.push_back(all[i]);
  return some;
}

}  // namespace

ShiftScores::ShiftScores() {
  for (std::vector<float>& sums : sums_) sums.resize(static_cast<std::size_t>(kNumShifts) * kNumShifts);
}

void ShiftScores::add(const PreparedView& view) {
  const Image<float> along_row = find_contrast(view.frame.color, 1, 0);
  const Image<float> along_column = find_contrast(view.frame.color, 0, 1);
  const double middle_u = 0.5 * (view.frame.color.width() - 1);
  const double middle_v = 0.5 * (view.frame.color.height() - 1);
  for (const ContourPixel& pixel : find_contour_pixels(view)) {
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
  }
  best.num_contour_pixels = num_pixels_;
  return best;
}

}  // namespace resight
