// SPDX-License-Identifier: Apache-2.0
#include "resight/geometry/lens.hpp"

#include <algorithm>
#include <cmath>
#include <string>

namespace resight {
namespace {

/// Radial part of the polynomial model, a factor, as a function of the squared radius.
double radial_factor(const std::array<double, 8>& k, double r_sq) {
  const double numerator = 1 + r_sq * (k[0] + r_sq * (k[1] + r_sq * k[4]));
  const double denominator = 1 + r_sq * (k[5] + r_sq * (k[6] + r_sq * k[7]));
  return numerator / denominator;
}

/// Angle of the distorted ray: theta (1 + k1 theta^2 + ... + k4 theta^8).
double distorted_angle(const std::array<double, 8>& k, double theta) {
  const double t = theta * theta;
  return theta * (1 + t * (k[0] + t * (k[1] + t * (k[2] + t * k[3]))));
}

/// "Brown Conrady", "rs2_distortion_brown_conrady" and "brown_conrady" are one name.
std::string normalize_name(std::string_view model) {
  std::string name(model);
  std::ranges::transform(name, name.begin(), [](char c) {
    if (c == ' ' || c == '-') return '_';
    return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  });
  return name.starts_with("rs2_distortion_") ? name.substr(15) : name;
}

bool is_polynomial_name(std::string_view model) {
  return model == "plumb_bob" || model == "rational_polynomial" || model == "radtan" || model == "radial_tangential" ||
         model == "opencv" || model == "brown_conrady";
}

bool is_modified_polynomial_name(std::string_view model) {
  return model == "modified_brown_conrady" || model == "inverse_brown_conrady";
}

bool is_equidistant_name(std::string_view model) {
  return model == "equidistant" || model == "fisheye" || model == "kannala_brandt4" || model == "kannala_brandt" ||
         model == "opencv_fisheye";
}

}  // namespace

Result<LensDistortion> LensDistortion::make(std::string_view given_model, std::span<const double> coefficients) {
  const std::string model = normalize_name(given_model);
  LensDistortion lens;
  if (!std::ranges::all_of(coefficients, [](double k) { return std::isfinite(k); }))
    return Error{"a distortion coefficient is NaN or infinite"};
  if (std::ranges::all_of(coefficients, [](double k) { return k == 0; })) return lens;
  const std::size_t count = coefficients.size();
  if (is_equidistant_name(model)) {
    if (count != 4) return Error{"the equidistant distortion has " + std::to_string(count) + " coefficients, not 4"};
    lens.kind_ = Kind::kEquidistant;
  } else if (model.empty() || is_polynomial_name(model) || is_modified_polynomial_name(model)) {
    const auto rest = coefficients.subspan(std::min<std::size_t>(count, lens.k_.size()));
    const bool thin_prism = std::ranges::any_of(rest, [](double k) { return k != 0; });
    if (count < 4 || thin_prism)
      return Error{"a lens with " + std::to_string(count) + " distortion coefficients is not supported (4 to 8 are)"};
    lens.kind_ = is_modified_polynomial_name(model) ? Kind::kModifiedPolynomial : Kind::kPolynomial;
  } else {
    return Error{"the distortion model '" + std::string(given_model.substr(0, 40)) +
                 "' is not supported (plumb_bob, rational_polynomial and equidistant are)"};
  }
  std::copy_n(coefficients.begin(), std::min<std::size_t>(count, lens.k_.size()), lens.k_.begin());
  return lens;
}

std::optional<Eigen::Vector2d> LensDistortion::distort(const Eigen::Vector2d& ideal) const {
  constexpr double kStep = 1e-4;
  if (kind_ == Kind::kNone) return ideal;
  const double r = ideal.norm();
  if (kind_ == Kind::kEquidistant) {
    if (r < 1e-12) return ideal;
    const double theta = std::atan(r);
    const double bent = distorted_angle(k_, theta);
    if (!(distorted_angle(k_, theta + kStep) > bent)) return std::nullopt;
    return Eigen::Vector2d(ideal * (bent / r));
  }
  const double factor = radial_factor(k_, r * r);
  const double further = radial_factor(k_, (r + kStep) * (r + kStep));
  if (!(further * (r + kStep) > factor * r)) return std::nullopt;
  const Eigen::Vector2d radial = factor * ideal;
  const double x = kind_ == Kind::kModifiedPolynomial ? radial.x() : ideal.x();
  const double y = kind_ == Kind::kModifiedPolynomial ? radial.y() : ideal.y();
  return Eigen::Vector2d(radial.x() + 2 * k_[2] * x * y + k_[3] * (r * r + 2 * x * x),
                         radial.y() + k_[2] * (r * r + 2 * y * y) + 2 * k_[3] * x * y);
}

}  // namespace resight
