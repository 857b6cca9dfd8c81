// SPDX-License-Identifier: Apache-2.0
#include "resight/registration/depth_bias.hpp"

#include <cmath>

#include "resight/registration/bias_adjustment.hpp"
#include "resight/sensor/disparity_error.hpp"

namespace resight {
namespace {

constexpr double kMinSigmas = 3;

}  // namespace

bool DepthBias::is_significant() const {
  return std::abs(per_m) > kMinSigmas * sigma_per_m && std::abs(per_m) < kMaxDepthBias_per_m;
}

float DepthBias::corrected_m(float measured_m) const {
  return is_significant() ? without_disparity_error_m(measured_m, per_m) : measured_m;
}

DepthBias estimate_depth_bias(std::span<const AlignmentTarget> views, const DepthBiasOptions& options) {
  options.check();
  DepthBias bias;
  bias.num_views = static_cast<int>(views.size());
  if (views.size() < 2) return bias;
  const BiasAdjustment adjustment(views, options.num_threads);
  const BiasEstimate all = adjustment.solve();
  double variance = all.sigma_per_m * all.sigma_per_m;
  for (const auto& [one, other] : kHalvesOfViews) {
    const double half_difference =
        0.5 * (adjustment.solve_part(all, one).per_m - adjustment.solve_part(all, other).per_m);
    variance += half_difference * half_difference / kHalvesOfViews.size();
  }
  bias.per_m = all.per_m;
  bias.sigma_per_m = std::sqrt(variance);
  return bias;
}

void correct_depth(const DepthBias& bias, RgbdFrame& frame) {
  if (bias.is_significant()) remove_disparity_error(bias.per_m, frame);
}

}  // namespace resight
