// SPDX-License-Identifier: Apache-2.0
#include "resight/report/line_plot.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "resight/core/check.hpp"
#include "resight/report/internal/html.hpp"

namespace resight {
namespace {

constexpr double kWidth = 560, kHeight = 360;
constexpr double kLeft = 64, kRight = 16, kTop = 36, kBottom = 78;
// Distinguishable with common colour vision deficiencies (Okabe and Ito).
constexpr std::array kColors{"#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#000000"};

struct Range {
  double low = std::numeric_limits<double>::infinity();
  double high = -std::numeric_limits<double>::infinity();
  void include(double value) {
    if (!std::isfinite(value)) return;
    low = std::min(low, value);
    high = std::max(high, value);
  }
  [[nodiscard]] bool empty() const { return !(low <= high); }
};

// Step of 1, 2 or 5 times a power of ten, such that about `count` steps fill the range.
double round_step(double range, int count) {
  const double raw = range / count;
  const double power = std::pow(10, std::floor(std::log10(raw)));
  for (const double factor : {1.0, 2.0, 5.0})
    if (factor * power >= raw * 0.999) return factor * power;
  return 10 * power;
}

class SvgPlot {
 public:
  explicit SvgPlot(const LinePlot& plot) : plot_(plot) { find_ranges(); }

  std::string format() {
    text_ = fmt::format(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {0:g} {1:g}\" width=\"{0:g}\" height=\"{1:g}\" "
        "font-family=\"sans-serif\" font-size=\"12\">\n<rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>\n",
        kWidth, kHeight);
    label(kWidth / 2, 20, "middle", plot_.title, " font-size=\"14\"");
    draw_axes();
    for (std::size_t i = 0; i < plot_.series.size(); ++i) draw_series(plot_.series[i], i);
    return text_ + "</svg>\n";
  }

 private:
  void find_ranges() {
    for (const PlotSeries& s : plot_.series) {
      require(s.x.size() == s.y.size(), "LinePlot: x and y of series '" + s.name + "' differ in length");
      for (std::size_t i = 0; i < s.x.size(); ++i) {
        x_.include(s.x[i]);
        y_.include(s.y[i]);
      }
    }
    if (x_.empty()) x_ = {0, 1};
    if (x_.low == x_.high) x_.high = x_.low + 1;
    y_.include(0);
    if (y_.low == y_.high) y_.high = y_.low + 1;
    if (plot_.y_min) y_.low = *plot_.y_min;
    if (plot_.y_max) y_.high = *plot_.y_max;
  }

  [[nodiscard]] double px(double x) const {
    return kLeft + (x - x_.low) / (x_.high - x_.low) * (kWidth - kLeft - kRight);
  }
  [[nodiscard]] double py(double y) const {
    return kHeight - kBottom - (y - y_.low) / (y_.high - y_.low) * (kHeight - kTop - kBottom);
  }

  void label(double x, double y, const char* anchor, const std::string& what, const std::string& extra = {}) {
    text_ += fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"{}\"{}>{}</text>\n", x, y, anchor, extra,
                         report::escape(what));
  }
  void line(double x1, double y1, double x2, double y2, const char* color) {
    text_ += fmt::format("<line x1=\"{:.1f}\" y1=\"{:.1f}\" x2=\"{:.1f}\" y2=\"{:.1f}\" stroke=\"{}\"/>\n", x1, y1, x2,
                         y2, color);
  }

  void draw_axes() {
    const double y_step = round_step(y_.high - y_.low, 6);
    for (double y = std::ceil(y_.low / y_step - 1e-9) * y_step; y <= y_.high + 1e-9 * y_step; y += y_step) {
      line(kLeft, py(y), kWidth - kRight, py(y), "#ddd");
      label(kLeft - 6, py(y) + 4, "end", fmt::format("{:.6g}", std::abs(y) < 1e-9 * y_step ? 0.0 : y));
    }
    const double x_step = std::max(1.0, round_step(x_.high - x_.low, 12));
    for (double x = std::ceil(x_.low / x_step - 1e-9) * x_step; x <= x_.high + 1e-9; x += x_step) {
      line(px(x), kHeight - kBottom, px(x), kHeight - kBottom + 4, "#000");
      label(px(x), kHeight - kBottom + 18, "middle", fmt::format("{:.6g}", x));
    }
    line(kLeft, kHeight - kBottom, kWidth - kRight, kHeight - kBottom, "#000");
    line(kLeft, kTop, kLeft, kHeight - kBottom, "#000");
    label((kLeft + kWidth - kRight) / 2, kHeight - kBottom + 36, "middle", plot_.x_label);
    label(16, (kTop + kHeight - kBottom) / 2, "middle", plot_.y_label,
          fmt::format(" transform=\"rotate(-90 16 {:.1f})\"", (kTop + kHeight - kBottom) / 2));
  }

  void draw_series(const PlotSeries& series, std::size_t index) {
    const char* color = kColors[index % kColors.size()];
    std::string path;
    bool is_down = false;
    for (std::size_t i = 0; i < series.x.size(); ++i) {
      if (!std::isfinite(series.x[i]) || !std::isfinite(series.y[i])) {
        is_down = false;
        continue;
      }
      path += fmt::format("{}{:.1f},{:.1f} ", is_down ? "L" : "M", px(series.x[i]), py(series.y[i]));
      text_ += fmt::format("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"3\" fill=\"{}\"/>\n", px(series.x[i]),
                           py(series.y[i]), color);
      is_down = true;
    }
    text_ += fmt::format("<path d=\"{}\" fill=\"none\" stroke=\"{}\" stroke-width=\"1.8\"/>\n", path, color);
    const auto row = index / 3;
    const double x = kLeft + static_cast<double>(index % 3) * 165;
    const double y = kHeight - 26 + static_cast<double>(row) * 16;
    line(x, y - 4, x + 18, y - 4, color);
    label(x + 24, y, "start", series.name);
  }

  const LinePlot& plot_;
  Range x_, y_;
  std::string text_;
};

}  // namespace

std::string format_svg(const LinePlot& plot) { return SvgPlot(plot).format(); }

}  // namespace resight
