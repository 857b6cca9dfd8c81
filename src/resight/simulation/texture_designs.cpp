// SPDX-License-Identifier: Apache-2.0
#include "resight/simulation/texture_designs.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <string_view>

namespace resight {
namespace {

constexpr Rgb8 kWhite{245, 245, 240};
constexpr Rgb8 kBlack{25, 25, 28};

double random_angle(Rng& rng) { return rng.uniform(0, 2 * std::numbers::pi); }

// Colour of a random shape, near the given hue or far from it, dark or bright, so that adjacent shapes differ.
Rgb8 random_color(Rng& rng, double hue_deg) {
  // One draw per statement, because compilers differ in the evaluation order of arguments.
  const double hue = hue_deg + (rng.uniform() < 0.5 ? rng.uniform(-40, 40) : rng.uniform(100, 260));
  const double saturation = rng.uniform(0.35, 0.95);
  const double value = rng.uniform() < 0.4 ? rng.uniform(0.2, 0.5) : rng.uniform(0.7, 1.0);
  return hsv_color(hue + 360, saturation, value);
}

void draw_random_shape(TextureCanvas& canvas, Rng& rng, double x, double y, double radius, Rgb8 color) {
  const std::uint32_t shape = rng.below(5);
  const double slimness = rng.uniform(0.35, 0.65);
  const double angle = random_angle(rng);
  const int points = 3 + static_cast<int>(rng.below(5));
  switch (shape) {
    case 0:
      canvas.disc(x, y, radius, color);
      break;
    case 1:
      canvas.ring(x, y, radius * 0.75, radius * 0.45, color);
      break;
    case 2:
      canvas.ellipse(x, y, radius, radius * slimness, angle, color);
      break;
    case 3:
      canvas.star(x, y, radius, radius * slimness, points, angle, color);
      break;
    default: {
      const double dx = radius * std::cos(angle);
      const double dy = radius * std::sin(angle);
      canvas.line(x - dx, y - dy, x + dx, y + dy, radius * 0.5, color);
    }
  }
}

void draw_background(TextureCanvas& canvas, const TextureStyle& style, Rng& rng) {
  canvas.gradient(style.base(), hsv_color(style.hue_deg + rng.uniform(-25, 25), 0.7, 0.55));
  const double w = canvas.width();
  const double h = canvas.height();
  const double tilt = rng.uniform(-0.3, 0.3) * w;
  const std::array<Eigen::Vector2d, 4> wedge{Eigen::Vector2d(0, h * rng.uniform(0.4, 0.6)),
                                             Eigen::Vector2d(w, h * rng.uniform(0.4, 0.6) + 0.3 * tilt),
                                             Eigen::Vector2d(w, h), Eigen::Vector2d(0, h)};
  canvas.polygon(wedge, style.light());
}

}  // namespace

std::string make_word(Rng& rng, int syllables) {
  constexpr std::string_view kConsonants = "BCDFGHJKLMNPRSTVWZ";
  constexpr std::string_view kVowels = "AEIOU";
  std::string word;
  for (int i = 0; i < syllables; ++i) {
    word += kConsonants[rng.below(static_cast<std::uint32_t>(kConsonants.size()))];
    word += kVowels[rng.below(static_cast<std::uint32_t>(kVowels.size()))];
    if (rng.uniform() < 0.35) word += kConsonants[rng.below(static_cast<std::uint32_t>(kConsonants.size()))];
  }
  return word;
}

void print_blobs(TextureCanvas canvas, Rng rng, double hue_deg, int count, double min_radius_mm, double max_radius_mm) {
  for (int i = 0; i < count; ++i) {
    const double radius = min_radius_mm + (max_radius_mm - min_radius_mm) * std::pow(rng.uniform(), 2.0);
    const double x = rng.uniform(0, canvas.width());
    const double y = rng.uniform(0, canvas.height());
    const Rgb8 color = random_color(rng, hue_deg);
    draw_random_shape(canvas, rng, x, y, radius, color);
    if (rng.uniform() < 0.5) canvas.disc(x, y, radius * 0.3, random_color(rng, hue_deg));
  }
}

void print_emblem(TextureCanvas canvas, Rng rng, double x, double y, double radius_mm, double hue_deg) {
  canvas.disc(x, y, radius_mm, random_color(rng, hue_deg));
  const double inner = radius_mm * rng.uniform(0.4, 0.75);
  const int points = 5 + static_cast<int>(rng.below(8));
  const double turn = random_angle(rng);
  canvas.star(x, y, radius_mm * 0.92, inner, points, turn, random_color(rng, hue_deg + 120));
  canvas.disc(x, y, radius_mm * 0.5, random_color(rng, hue_deg));
  const int petals = 3 + static_cast<int>(rng.below(4));
  const Rgb8 petal = random_color(rng, hue_deg + 200);
  const double start = random_angle(rng);
  for (int i = 0; i < petals; ++i) {
    const double angle = start + 2 * std::numbers::pi * i / petals;
    canvas.ellipse(x + radius_mm * 0.25 * std::cos(angle), y + radius_mm * 0.25 * std::sin(angle), radius_mm * 0.22,
                   radius_mm * 0.1, angle, petal);
  }
}

void print_paragraph(TextureCanvas canvas, Rng rng, double x, double y, double width, double height, double letter_mm,
                     Rgb8 color) {
  for (double line = y; line + letter_mm <= y + height; line += 1.7 * letter_mm) {
    double pen = x;
    while (true) {
      const std::string word = make_word(rng, 1 + static_cast<int>(rng.below(4)));
      const double length = text_width(word) * letter_mm;
      if (pen + length > x + width) break;
      canvas.text(pen, line, letter_mm, 0.17 * letter_mm, word, color);
      pen += length + 0.8 * letter_mm;
    }
  }
}

void print_barcode(TextureCanvas canvas, Rng rng, double x, double y, double width, double height) {
  canvas.rect(x, y, width, height, kWhite);
  const double unit = width / 60;
  for (double pen = x + 3 * unit; pen < x + width - 6 * unit;) {
    const double bar = unit * (1 + rng.below(3));
    canvas.rect(pen, y + 0.08 * height, bar, 0.7 * height, kBlack);
    pen += bar + unit * (1 + rng.below(3));
  }
  std::string digits;
  for (int i = 0; i < 10; ++i) digits += static_cast<char>('0' + rng.below(10));
  canvas.text_in_box(x + 0.1 * width, y + 0.82 * height, 0.8 * width, 0.15 * height, digits, kBlack);
}

void print_grain(TextureCanvas canvas, Rng rng, Rgb8 color, int count, double min_radius_mm, double max_radius_mm) {
  const auto shift = [&](std::uint8_t c, double by) {
    return static_cast<std::uint8_t>(std::clamp(c + by, 0.0, 255.0));
  };
  for (int i = 0; i < count; ++i) {
    const double by = 4 * rng.normal();
    const double x = rng.uniform(0, canvas.width());
    const double y = rng.uniform(0, canvas.height());
    canvas.disc(x, y, rng.uniform(min_radius_mm, max_radius_mm),
                {shift(color.r, by), shift(color.g, by), shift(color.b, by)});
  }
}

void print_wood(TextureCanvas canvas, Rng rng, Rgb8 light, Rgb8 dark, double plank_mm) {
  const double w = canvas.width();
  for (double top = 0; top < canvas.height(); top += plank_mm) {
    TextureCanvas plank = canvas.part(0, top, w, std::min(plank_mm, canvas.height() - top));
    const double tone = rng.uniform(0, 0.35);
    const auto mix = [&](double t) {
      const auto channel = [t](std::uint8_t a, std::uint8_t b) { return static_cast<std::uint8_t>(a + t * (b - a)); };
      return Rgb8{channel(light.r, dark.r), channel(light.g, dark.g), channel(light.b, dark.b)};
    };
    plank.fill(mix(tone));
    const int lines = static_cast<int>(plank_mm / 4);
    for (int i = 0; i < lines; ++i) {  // growth rings: long gentle waves
      const double y0 = rng.uniform(0, plank.height());
      const double wave = rng.uniform(0, 3);
      const double length = rng.uniform(100, 400);
      const double phase = random_angle(rng);
      const double thickness = rng.uniform(0.4, 1.6);
      const Rgb8 color = mix(std::min(1.0, tone + rng.uniform(0.05, 0.3)));
      constexpr double kStep = 20;
      const auto height_at = [&](double x) { return y0 + wave * std::sin(phase + 2 * std::numbers::pi * x / length); };
      for (double x = 0; x < w; x += kStep)
        plank.line(x, height_at(x), x + kStep, height_at(x + kStep), thickness, color);
    }
    plank.rect(0, 0, w, 0.8, mix(1.0));
  }
}

void print_front(TextureCanvas canvas, const TextureStyle& style, std::uint64_t part) {
  Rng rng = style.stream(part);
  const double w = canvas.width();
  const double h = canvas.height();
  const double unit = std::sqrt(w * h);
  draw_background(canvas, style, rng);
  print_blobs(canvas.part(0, 0.42 * h, w, 0.42 * h), style.stream(part + 100), style.hue_deg + 60,
              40 + static_cast<int>(rng.below(12)), 0.02 * unit, 0.09 * unit);
  const double emblem_x = rng.uniform(0.25, 0.75) * w;
  const double emblem_y = rng.uniform(0.55, 0.7) * h;
  print_emblem(canvas, style.stream(part + 200), emblem_x, emblem_y, 0.17 * unit, style.hue_deg);
  canvas.rounded_rect(0.05 * w, 0.06 * h, 0.9 * w, 0.25 * h, 0.04 * unit, style.dark());
  canvas.text_in_box(0.08 * w, 0.08 * h, 0.84 * w, 0.21 * h, style.brand, style.light(), 0.2);
  canvas.rect(0.1 * w, 0.33 * h, 0.8 * w, 0.09 * h, style.accent());
  canvas.text_in_box(0.12 * w, 0.345 * h, 0.76 * w, 0.06 * h, style.product, kBlack);
  const double badge_x = rng.uniform(0.15, 0.85) * w;
  const double badge_y = 0.84 * h;
  canvas.star(badge_x, badge_y, 0.11 * unit, 0.085 * unit, 12, 0.2, style.accent());
  canvas.text_in_box(badge_x - 0.07 * unit, badge_y - 0.04 * unit, 0.14 * unit, 0.08 * unit,
                     std::to_string(10 + rng.below(90)), kBlack);
  canvas.rect(0, 0.93 * h, w, 0.07 * h, style.dark());
  std::string small_print = make_word(rng, 3) + " ";
  small_print += make_word(rng, 2) + " ";
  small_print += std::to_string(100 + rng.below(900)) + "G";
  canvas.text_in_box(0.05 * w, 0.94 * h, 0.9 * w, 0.05 * h, small_print, style.light());
}

void print_back(TextureCanvas canvas, const TextureStyle& style, std::uint64_t part) {
  const double w = canvas.width();
  const double h = canvas.height();
  const double unit = std::sqrt(w * h);
  canvas.gradient(style.light(), hsv_color(style.hue_deg + 40, 0.3, 0.85));
  canvas.rect(0, 0, w, 0.16 * h, style.base());
  canvas.text_in_box(0.05 * w, 0.03 * h, 0.6 * w, 0.1 * h, style.brand, kWhite, 0.2);
  print_emblem(canvas, style.stream(part + 200), 0.83 * w, 0.09 * h, 0.09 * unit, style.hue_deg + 90);
  print_blobs(canvas.part(0.05 * w, 0.2 * h, 0.5 * w, 0.4 * h), style.stream(part + 100), style.hue_deg + 150, 34,
              0.015 * unit, 0.06 * unit);
  print_paragraph(canvas, style.stream(part + 300), 0.6 * w, 0.2 * h, 0.36 * w, 0.4 * h, 0.022 * unit, kBlack);
  canvas.rounded_rect(0.05 * w, 0.64 * h, 0.5 * w, 0.3 * h, 0.03 * unit, style.accent());
  print_paragraph(canvas, style.stream(part + 400), 0.08 * w, 0.67 * h, 0.44 * w, 0.25 * h, 0.03 * unit, style.dark());
  print_barcode(canvas, style.stream(part + 500), 0.62 * w, 0.7 * h, 0.33 * w, 0.2 * h);
}

void print_side(TextureCanvas canvas, const TextureStyle& style, std::uint64_t part) {
  Rng rng = style.stream(part);
  const double w = canvas.width();
  const double h = canvas.height();
  canvas.gradient(hsv_color(style.hue_deg + rng.uniform(-30, 30), 0.6, 0.8), style.base());
  const double top = rng.uniform(0.3, 0.45) * h;
  print_blobs(canvas.part(0, 0, w, top), style.stream(part + 100), style.hue_deg + 90, 20, 0.05 * w, 0.16 * w);
  canvas.text_in_box(0.06 * w, 0.08 * h, 0.88 * w, 0.14 * h, style.brand, kWhite, 0.22);
  canvas.rect(0.08 * w, top, 0.84 * w, 0.9 * h - top, kWhite);
  const int rows = 4 + static_cast<int>(rng.below(5));
  for (int i = 0; i < rows; ++i) {
    const double y = top + (0.9 * h - top) * (i + 0.15) / rows;
    const double letter = 0.5 * (0.9 * h - top) / rows;
    canvas.text_in_box(0.1 * w, y, 0.5 * w, letter, make_word(rng, 2 + static_cast<int>(rng.below(2))), kBlack);
    canvas.text_in_box(0.66 * w, y, 0.22 * w, letter, std::to_string(rng.below(100)) + "%", style.dark());
    canvas.rect(0.1 * w, y + 1.35 * letter, 0.8 * w, std::max(0.3, 0.1 * letter), style.base());
  }
}

void print_lid(TextureCanvas canvas, const TextureStyle& style, std::uint64_t part) {
  Rng rng = style.stream(part);
  const double w = canvas.width();
  const double h = canvas.height();
  const double unit = std::min(w, h);
  canvas.fill(style.base());
  const double period = unit * rng.uniform(0.25, 0.4);
  const double slant = random_angle(rng);
  canvas.stripes(period, slant, hsv_color(style.hue_deg + rng.uniform(-40, 40), 0.5, 0.9));
  print_blobs(canvas, style.stream(part + 100), style.hue_deg + 200, 14, 0.05 * unit, 0.14 * unit);
  canvas.rounded_rect(0.15 * w, 0.3 * h, 0.7 * w, 0.4 * h, 0.1 * unit, style.dark());
  canvas.text_in_box(0.2 * w, 0.36 * h, 0.6 * w, 0.28 * h, style.product, style.light(), 0.2);
}

void print_label(TextureCanvas canvas, const TextureStyle& style, std::uint64_t part) {
  const double w = canvas.width();
  const double h = canvas.height();
  print_side(canvas.part(0, 0, 0.14 * w, h), style, part + 1);
  print_back(canvas.part(0.14 * w, 0, 0.19 * w, h), style, part + 2);
  print_front(canvas.part(0.33 * w, 0, 0.34 * w, h), style, part + 3);
  print_back(canvas.part(0.67 * w, 0, 0.19 * w, h), style, part + 4);
  print_side(canvas.part(0.86 * w, 0, 0.14 * w, h), style, part + 5);
}

}  // namespace resight
