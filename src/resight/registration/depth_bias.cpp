// SPDX-License-Identifier: Apache-2.0
#include "resight/registration/depth_bias.hpp"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "resight/registration/bias_adjustment.hpp"

namespace resight {
namespace {

constexpr double kMaxBias_per_m = 0.05;  // More is a wrong unit or another law.
constexpr double kMinSigmas = 3;

}  // namespace

bool DepthBias::is_significant() const {
  return std::abs(per_m) > kMinSigmas * sigma_per_m && std::abs(per_m) < kMaxBias_per_m;
}

float DepthBias::corrected_m(float measured_m) const {
  if (!is_significant()) return measured_m;
  const auto share = static_cast<float>(1 - per_m * static_cast<double>(measured_m));
  return share > 0 ? measured_m / share : std::numeric_limits<float>::quiet_NaN();
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

DepthBias measure_depth_bias(const Sequence& sequence, const PrepareViewOptions& prepare,
                             const DepthBiasOptions& options) {
  if (!options.correct) return {};
  const int num_views = std::min(sequence.num_views(), kMaxBiasViews);
  std::vector<AlignmentView> kept;
  std::vector<AlignmentTarget> views;
  kept.reserve(static_cast<std::size_t>(num_views));
  for (int k = 0; k < num_views; ++k) {
    const int v = num_views > 1 ? k * (sequence.num_views() - 1) / (num_views - 1) : 0;
    Result<RgbdFrame> frame = sequence.read_view(v);
    if (!frame) continue;
    const PreparedView view = prepare_view(std::move(*frame), prepare);
    AlignmentView aligned = make_alignment_view(view);
    if (aligned.levels.empty()) continue;
    kept.push_back(std::move(aligned));
    views.push_back({&kept.back(), view.frame.world_from_camera});
  }
  return estimate_depth_bias(views, options);
}

void correct_depth(const DepthBias& bias, RgbdFrame& frame) {
  if (!bias.is_significant()) return;
  for (std::size_t i = 0; i < frame.depth_m.size(); ++i) frame.depth_m[i] = bias.corrected_m(frame.depth_m[i]);
}

}  // namespace resight
