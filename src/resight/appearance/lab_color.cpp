// SPDX-License-Identifier: Apache-2.0
#include "resight/appearance/lab_color.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "resight/appearance/photometric_fit.hpp"

namespace resight {
namespace {

constexpr int kCurveSteps = 4096;

using Curve = std::array<float, kCurveSteps + 2>;  // CIE f(t) for t in [0, 1]

double cie_curve(double t) {
  constexpr double kDelta = 6.0 / 29.0;
  return t > kDelta * kDelta * kDelta ? std::cbrt(t) : t / (3 * kDelta * kDelta) + 4.0 / 29.0;
}

Curve make_curve() {
  Curve curve;
  for (int i = 0; i < kCurveSteps + 2; ++i)
    curve[static_cast<std::size_t>(i)] = static_cast<float>(cie_curve(static_cast<double>(i) / kCurveSteps));
  return curve;
}

float look_up(const Curve& curve, float t) {
  const float position = std::clamp(t, 0.0F, 1.0F) * kCurveSteps;
  const int i = static_cast<int>(position);
  const float f = position - static_cast<float>(i);
  return curve[i] * (1 - f) + curve[i + 1] * f;
}

}  // namespace

Rgb8 to_grey(Rgb8 color) {
  const int luma = (299 * color.r + 587 * color.g + 114 * color.b + 500) / 1000;
  const auto level = static_cast<std::uint8_t>(luma);
  return {level, level, level};
}

LabColor to_lab(Rgb8 color) { return to_lab(to_linear_light(color)); }

LabColor to_lab(const Eigen::Vector3f& linear_light) {
  static const Curve curve = make_curve();
  const float r = linear_light.x();
  const float g = linear_light.y();
  const float b = linear_light.z();
  // sRGB primaries to XYZ; each row is divided by the D65 white point.
  const float fx = look_up(curve, 0.433953F * r + 0.376219F * g + 0.189828F * b);
  const float fy = look_up(curve, 0.212671F * r + 0.715160F * g + 0.072169F * b);
  const float fz = look_up(curve, 0.017758F * r + 0.109477F * g + 0.872765F * b);
  return {(116 * fy - 16 - 50) / 50, 500 * (fx - fy) / 128, 200 * (fy - fz) / 128};
}

std::vector<LabColor> to_lab(std::span<const Eigen::Vector3f> linear_light) {
  std::vector<LabColor> result;
  result.reserve(linear_light.size());
  for (const Eigen::Vector3f& light : linear_light) result.push_back(to_lab(light));
  return result;
}

}  // namespace resight
