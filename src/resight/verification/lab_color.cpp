// SPDX-License-Identifier: Apache-2.0
#include "resight/verification/lab_color.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace resight {
namespace {

constexpr std::size_t kMinSamples = 10;
constexpr double kMinContrast = 0.02;  // Below this the model has one colour, and a ratio of contrasts is noise.
constexpr int kCurveSteps = 4096;

struct Tables {
  std::array<float, 256> linear;             // sRGB byte to linear light
  std::array<float, kCurveSteps + 2> curve;  // CIE f(t) over t in [0, 1]
};

double cie_curve(double t) {
  constexpr double kDelta = 6.0 / 29.0;
  return t > kDelta * kDelta * kDelta ? std::cbrt(t) : t / (3 * kDelta * kDelta) + 4.0 / 29.0;
}

Tables make_tables() {
  Tables tables;
  for (int i = 0; i < 256; ++i) {
    const double s = i / 255.0;
    tables.linear[i] = static_cast<float>(s <= 0.04045 ? s / 12.92 : std::pow((s + 0.055) / 1.055, 2.4));
  }
  for (int i = 0; i < kCurveSteps + 2; ++i)
    tables.curve[i] = static_cast<float>(cie_curve(static_cast<double>(i) / kCurveSteps));
  return tables;
}

float look_up_curve(const Tables& tables, float t) {
  const float position = std::clamp(t, 0.0F, 1.0F) * kCurveSteps;
  const int i = static_cast<int>(position);
  const float f = position - static_cast<float>(i);
  return tables.curve[i] * (1 - f) + tables.curve[i + 1] * f;
}

struct Moments {
  double mean = 0;
  double deviation = 0;
};

Moments find_moments(std::span<const float> values) {
  double sum = 0;
  double sum_sq = 0;
  for (const float v : values) {
    sum += v;
    sum_sq += static_cast<double>(v) * v;
  }
  const double n = static_cast<double>(values.size());
  const double mean = sum / n;
  return {mean, std::sqrt(std::max(0.0, sum_sq / n - mean * mean))};
}

}  // namespace

LabColor to_lab(Rgb8 color) {
  static const Tables tables = make_tables();
  const float r = tables.linear[color.r];
  const float g = tables.linear[color.g];
  const float b = tables.linear[color.b];
  // sRGB primaries to XYZ, each row divided by the D65 white point.
  const float fx = look_up_curve(tables, 0.433953F * r + 0.376219F * g + 0.189828F * b);
  const float fy = look_up_curve(tables, 0.212671F * r + 0.715160F * g + 0.072169F * b);
  const float fz = look_up_curve(tables, 0.017758F * r + 0.109477F * g + 0.872765F * b);
  return {(116 * fy - 16 - 50) / 50, 500 * (fx - fy) / 128, 200 * (fy - fz) / 128};
}

std::vector<LabColor> to_lab(std::span<const Rgb8> colors) {
  std::vector<LabColor> result;
  result.reserve(colors.size());
  for (const Rgb8 c : colors) result.push_back(to_lab(c));
  return result;
}

ExposureMap fit_exposure(std::span<const float> model_l, std::span<const float> scene_l, float max_shift,
                         float max_gain) {
  if (std::min(model_l.size(), scene_l.size()) < kMinSamples) return {};
  const Moments model = find_moments(model_l);
  const Moments scene = find_moments(scene_l);
  double gain = 1;
  if (model.deviation > kMinContrast)
    gain = std::clamp(scene.deviation / model.deviation, 1.0 / max_gain, static_cast<double>(max_gain));
  const double shift =
      std::clamp(scene.mean - model.mean, -static_cast<double>(max_shift), static_cast<double>(max_shift));
  return {static_cast<float>(gain), static_cast<float>(model.mean + shift - gain * model.mean)};
}

}  // namespace resight
