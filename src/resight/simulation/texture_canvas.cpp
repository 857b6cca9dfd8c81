// SPDX-License-Identifier: Apache-2.0
#include "resight/simulation/texture_canvas.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "resight/core/check.hpp"

namespace resight {
namespace {

using Eigen::Vector2d;

// Polylines on a 4 x 6 grid (x right, y down) as pairs of digits; '|' lifts the pen.
constexpr std::array<std::string_view, 26> kLetters = {"06 20 46|14 34",
                                                       "00 06 36 45 44 33 03|00 30 41 42 33",
                                                       "41 30 10 01 05 16 36 45",
                                                       "00 06 26 44 42 20 00",
                                                       "40 00 06 46|03 33",
                                                       "40 00 06|03 33",
                                                       "41 30 10 01 05 16 36 45 43 23",
                                                       "00 06|40 46|03 43",
                                                       "20 26|10 30|16 36",
                                                       "40 45 36 16 05",
                                                       "00 06|40 03 46",
                                                       "00 06 46",
                                                       "06 00 23 40 46",
                                                       "06 00 46 40",
                                                       "10 30 41 45 36 16 05 01 10",
                                                       "06 00 30 41 42 33 03",
                                                       "10 30 41 45 36 16 05 01 10|24 46",
                                                       "06 00 30 41 42 33 03|23 46",
                                                       "41 30 10 01 02 13 33 44 45 36 16 05",
                                                       "00 40|20 26",
                                                       "00 05 16 36 45 40",
                                                       "00 26 40",
                                                       "00 16 23 36 40",
                                                       "00 46|40 06",
                                                       "00 23 40|23 26",
                                                       "00 40 06 46"};
constexpr std::array<std::string_view, 10> kDigits = {
    "10 30 41 45 36 16 05 01 10|32 14",       "11 20 26|16 36", "01 10 30 41 42 06 46",
    "01 10 30 41 42 33 13|33 44 45 36 16 05", "36 30 04 44",    "40 00 03 33 44 45 36 16 05",
    "41 30 10 01 05 16 36 45 44 33 03",       "00 40 16",       "13 02 01 10 30 41 42 33 13 04 05 16 36 45 44 33",
    "43 13 02 01 10 30 41 45 36 16 05"};
constexpr double kAdvance = 5.6 / 6.0;  // advance per letter, relative to the height

std::string_view glyph(char c) {
  if (c >= 'A' && c <= 'Z') return kLetters[c - 'A'];
  if (c >= '0' && c <= '9') return kDigits[c - '0'];
  switch (c) {
    case '.':
      return "26 26";
    case '-':
      return "13 33";
    case '+':
      return "13 33|22 24";
    case '!':
      return "20 24|26 26";
    case '%':
      return "40 06|00 00|46 46";
    case '&':
      return "46 11 20 31 04 05 16 26 44";
    default:
      return "";
  }
}

double segment_distance(const Vector2d& p, const Vector2d& a, const Vector2d& b) {
  const Vector2d ab = b - a;
  const double length_sq = ab.squaredNorm();
  const double t = length_sq > 0 ? std::clamp((p - a).dot(ab) / length_sq, 0.0, 1.0) : 0.0;
  return (p - a - t * ab).norm();
}

// Signed distance; negative inside.
double polygon_distance(const Vector2d& p, std::span<const Vector2d> corners) {
  double nearest = std::numeric_limits<double>::infinity();
  bool inside = false;
  for (std::size_t i = 0, j = corners.size() - 1; i < corners.size(); j = i++) {
    const Vector2d& a = corners[i];
    const Vector2d& b = corners[j];
    nearest = std::min(nearest, segment_distance(p, a, b));
    if ((a.y() > p.y()) != (b.y() > p.y()) && p.x() < (b.x() - a.x()) * (p.y() - a.y()) / (b.y() - a.y()) + a.x())
      inside = !inside;
  }
  return inside ? -nearest : nearest;
}

double box_distance(const Vector2d& p, const Vector2d& center, const Vector2d& half) {
  const Vector2d d = (p - center).cwiseAbs() - half;
  return d.cwiseMax(0.0).norm() + std::min(d.maxCoeff(), 0.0);
}

Rgb8 blend(Rgb8 a, Rgb8 b, double share_of_b) {
  const auto mix = [share_of_b](std::uint8_t x, std::uint8_t y) {
    return static_cast<std::uint8_t>(std::lround((1 - share_of_b) * x + share_of_b * y));
  };
  return {mix(a.r, b.r), mix(a.g, b.g), mix(a.b, b.b)};
}

}  // namespace

TextureCanvas::TextureCanvas(Image<Rgb8>& image, PixelRect rect, double px_per_mm)
    : image_(&image), rect_(rect), scale_(px_per_mm) {
  require(rect.x >= 0 && rect.y >= 0 && rect.x + rect.width <= image.width() && rect.y + rect.height <= image.height(),
          "TextureCanvas: the rectangle is not within the image");
  check_positive("TextureCanvas px_per_mm", px_per_mm);
}

TextureCanvas TextureCanvas::part(double x, double y, double width, double height) const {
  const auto to_px = [this](double mm, int limit) {
    return std::clamp(static_cast<int>(std::lround(mm * scale_)), 0, limit);
  };
  const int x0 = to_px(x, rect_.width);
  const int y0 = to_px(y, rect_.height);
  return {*image_,
          {rect_.x + x0, rect_.y + y0, to_px(x + width, rect_.width) - x0, to_px(y + height, rect_.height) - y0},
          scale_};
}

template <typename SignedDistance>
void TextureCanvas::paint(double x0, double y0, double x1, double y1, Rgb8 color, SignedDistance&& distance_mm) {
  const auto first = [this](double mm, int limit) { return std::clamp(static_cast<int>(mm * scale_) - 1, 0, limit); };
  const auto last = [this](double mm, int limit) { return std::clamp(static_cast<int>(mm * scale_) + 2, 0, limit); };
  for (int v = first(y0, rect_.height); v < last(y1, rect_.height); ++v)
    for (int u = first(x0, rect_.width); u < last(x1, rect_.width); ++u) {
      const Vector2d p((u + 0.5) / scale_, (v + 0.5) / scale_);
      const double coverage = std::clamp(0.5 - distance_mm(p) * scale_, 0.0, 1.0);
      if (coverage <= 0) continue;
      Rgb8& pixel = (*image_)(rect_.x + u, rect_.y + v);
      pixel = coverage < 1 ? blend(pixel, color, coverage) : color;
    }
}

void TextureCanvas::fill(Rgb8 color) { gradient(color, color); }

void TextureCanvas::gradient(Rgb8 top, Rgb8 bottom) {
  for (int v = 0; v < rect_.height; ++v) {
    const Rgb8 color = blend(top, bottom, (v + 0.5) / rect_.height);
    for (int u = 0; u < rect_.width; ++u) (*image_)(rect_.x + u, rect_.y + v) = color;
  }
}

void TextureCanvas::rect(double x, double y, double width, double height, Rgb8 color) {
  rounded_rect(x, y, width, height, 0, color);
}

void TextureCanvas::rounded_rect(double x, double y, double width, double height, double radius, Rgb8 color) {
  const Vector2d center(x + width / 2, y + height / 2);
  const Vector2d half = Vector2d(width / 2, height / 2).array() - radius;
  paint(x, y, x + width, y + height, color, [&](const Vector2d& p) { return box_distance(p, center, half) - radius; });
}

void TextureCanvas::disc(double x, double y, double radius, Rgb8 color) {
  paint(x - radius, y - radius, x + radius, y + radius, color,
        [&](const Vector2d& p) { return (p - Vector2d(x, y)).norm() - radius; });
}

void TextureCanvas::ring(double x, double y, double radius, double thickness, Rgb8 color) {
  const double outer = radius + thickness / 2;
  paint(x - outer, y - outer, x + outer, y + outer, color,
        [&](const Vector2d& p) { return std::abs((p - Vector2d(x, y)).norm() - radius) - thickness / 2; });
}

void TextureCanvas::ellipse(double x, double y, double radius_x, double radius_y, double angle_rad, Rgb8 color) {
  const double reach = std::max(radius_x, radius_y);
  const double c = std::cos(angle_rad);
  const double s = std::sin(angle_rad);
  paint(x - reach, y - reach, x + reach, y + reach, color, [&](const Vector2d& p) {
    const Vector2d d = p - Vector2d(x, y);
    const Vector2d q((c * d.x() + s * d.y()) / radius_x, (-s * d.x() + c * d.y()) / radius_y);
    return (q.norm() - 1) * std::min(radius_x, radius_y);  // exact on the outline
  });
}

void TextureCanvas::line(double x0, double y0, double x1, double y1, double thickness, Rgb8 color) {
  const double r = thickness / 2;
  paint(std::min(x0, x1) - r, std::min(y0, y1) - r, std::max(x0, x1) + r, std::max(y0, y1) + r, color,
        [&](const Vector2d& p) {
          return segment_distance(p, {x0, y0}, {x1, y1}) - r;
        });
}

void TextureCanvas::polygon(std::span<const Vector2d> corners, Rgb8 color) {
  if (corners.size() < 3) return;
  Vector2d low = corners[0];
  Vector2d high = corners[0];
  for (const Vector2d& c : corners) {
    low = low.cwiseMin(c);
    high = high.cwiseMax(c);
  }
  paint(low.x(), low.y(), high.x(), high.y(), color, [&](const Vector2d& p) { return polygon_distance(p, corners); });
}

void TextureCanvas::star(double x, double y, double outer_radius, double inner_radius, int points, double angle_rad,
                         Rgb8 color) {
  std::vector<Vector2d> corners;
  for (int i = 0; i < 2 * points; ++i) {
    const double angle = angle_rad + std::numbers::pi * i / points;
    const double radius = i % 2 == 0 ? outer_radius : inner_radius;
    corners.emplace_back(x + radius * std::sin(angle), y - radius * std::cos(angle));
  }
  polygon(corners, color);
}

void TextureCanvas::stripes(double period, double angle_rad, Rgb8 color) {
  const Vector2d across(std::cos(angle_rad), std::sin(angle_rad));
  paint(0, 0, width(), height(), color, [&](const Vector2d& p) {
    const double phase = p.dot(across) / period;
    return (std::abs(phase - std::floor(phase) - 0.5) - 0.25) * period;
  });
}

void TextureCanvas::text(double x, double y, double height, double stroke, std::string_view text, Rgb8 color) {
  const double unit = height / 6.0;
  for (const char c : text) {
    const std::string_view pen = glyph(c);
    for (std::size_t i = 0; i + 4 < pen.size(); i += 3) {
      if (pen[i + 2] == '|') continue;
      line(x + (pen[i] - '0') * unit, y + (pen[i + 1] - '0') * unit, x + (pen[i + 3] - '0') * unit,
           y + (pen[i + 4] - '0') * unit, stroke, color);
    }
    x += kAdvance * height;
  }
}

void TextureCanvas::text_in_box(double x, double y, double width, double height, std::string_view text, Rgb8 color,
                                double stroke_share) {
  const double size = std::min(height / (1 + stroke_share), width / (text_width(text) + stroke_share));
  this->text(x + (width - size * text_width(text)) / 2, y + (height - size) / 2, size, stroke_share * size, text,
             color);
}

double text_width(std::string_view text) {
  return text.empty() ? 0.0 : kAdvance * (static_cast<double>(text.size()) - 1) + 4.0 / 6.0;
}

Rgb8 hsv_color(double hue_deg, double saturation, double value) {
  const double h = hue_deg / 60.0 - 6.0 * std::floor(hue_deg / 360.0);
  const auto channel = [&](double n) {
    const double k = std::fmod(n + h, 6.0);
    const double x = value * (1 - saturation * std::max(0.0, std::min({k, 4 - k, 1.0})));
    return static_cast<std::uint8_t>(std::lround(255 * std::clamp(x, 0.0, 1.0)));
  };
  return {channel(5), channel(3), channel(1)};
}

}  // namespace resight
