// SPDX-License-Identifier: Apache-2.0
#include "resight/inspection/color_values.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "resight/core/statistics.hpp"

namespace resight {
namespace {

constexpr float kMinRise = 40;  // Grey levels over a whole edge; weaker ones drown in noise.
constexpr std::size_t kMinEdges = 200;
constexpr double kReferenceLength_px = 640;

float grey_of(const Rgb8& c) { return static_cast<float>(c.r + c.g + c.b) / 3; }

/// Brightness along a line of pixels, smoothed by (1 2 1) / 4.
std::vector<float> smooth_line(const std::vector<float>& line) {
  std::vector<float> smooth = line;
  for (std::size_t i = 1; i + 1 < line.size(); ++i) smooth[i] = (line[i - 1] + 2 * line[i] + line[i + 1]) / 4;
  return smooth;
}

/// Adds the lengths of the runs that rise or fall by at least kMinRise. Steps of less than half a grey level are flat
/// and end a run.
void add_widths(const std::vector<float>& line, std::vector<float>& widths_px) {
  constexpr float kFlat = 0.5F;
  for (std::size_t begin = 0; begin + 1 < line.size();) {
    const float first = line[begin + 1] - line[begin];
    std::size_t end = begin + 1;
    while (end + 1 < line.size() && (line[end + 1] - line[end]) * first > 0 &&
           std::abs(line[end + 1] - line[end]) >= kFlat)
      ++end;
    if (std::abs(line[end] - line[begin]) >= kMinRise) {
      // From 10 to 90 %: the ends of an edge are vague.
      const float low = std::min(line[begin], line[end]) + 0.1F * std::abs(line[end] - line[begin]);
      const float high = std::max(line[begin], line[end]) - 0.1F * std::abs(line[end] - line[begin]);
      float inside = 0;
      for (std::size_t i = begin; i < end; ++i) {
        const float a = std::min(line[i], line[i + 1]), b = std::max(line[i], line[i + 1]);
        inside += std::max(0.0F, std::min(b, high) - std::max(a, low)) / (b - a);
      }
      widths_px.push_back(inside);
    }
    begin = end;
  }
}

double median_width_px(const Image<Rgb8>& color, bool along_rows) {
  std::vector<float> widths_px;
  const int num_lines = along_rows ? color.height() : color.width();
  const int length = along_rows ? color.width() : color.height();
  std::vector<float> line(static_cast<std::size_t>(length));
  for (int l = 0; l < num_lines; l += 2) {
    for (int i = 0; i < length; ++i)
      line[static_cast<std::size_t>(i)] = grey_of(along_rows ? color(i, l) : color(l, i));
    add_widths(smooth_line(line), widths_px);
  }
  if (widths_px.size() < kMinEdges) return std::numeric_limits<double>::quiet_NaN();
  return static_cast<double>(upper_median(std::move(widths_px))) * kReferenceLength_px /
         std::max({kReferenceLength_px, 1.0 * color.width(), 1.0 * color.height()});
}

}  // namespace

ColorValues measure_color_values(const Image<Rgb8>& color) {
  ColorValues values;
  std::array<std::size_t, 256> counts{};
  for (const Rgb8& c : color.data()) ++counts[static_cast<std::size_t>(grey_of(c))];
  std::size_t num_darker = 0;
  for (std::size_t level = 0; level < counts.size(); ++level) {
    num_darker += counts[level];
    if (static_cast<double>(num_darker) < 0.95 * static_cast<double>(color.size())) continue;
    values.bright_grey = static_cast<double>(level);
    break;
  }
  const double along_rows_px = median_width_px(color, true);
  const double along_columns_px = median_width_px(color, false);
  values.edge_width_px = std::fmax(along_rows_px, along_columns_px);  // NaN only if both are
  return values;
}

}  // namespace resight
