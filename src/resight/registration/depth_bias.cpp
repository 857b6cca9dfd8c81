// SPDX-License-Identifier: Apache-2.0
#include "resight/registration/depth_bias.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "resight/registration/bias_adjustment.hpp"
#include "resight/sensor/disparity_error.hpp"

namespace resight {
namespace {

constexpr double kMinSigmas = 3;

std::vector<int> spread_views(int num_views) {
  const int count = std::min(num_views, kMaxBiasViews);
  std::vector<int> views;
  for (int k = 0; k < count; ++k) views.push_back(count > 1 ? k * (num_views - 1) / (count - 1) : 0);
  return views;
}

// By the given poses. Poses that cannot be read are no evidence.
bool stands_still(const Sequence& sequence, std::span<const int> views) {
  std::optional<Rigid3> first;
  for (const int v : views) {
    const Result<Rigid3> pose = sequence.read_pose(v);
    if (!pose) continue;
    if (first && first->matrix() != pose->matrix()) return false;
    first = *pose;
  }
  return true;
}

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

DepthBias measure_depth_bias(const Sequence& sequence, const PrepareViewOptions& prepare,
                             const DepthBiasOptions& options) {
  if (!options.correct) return {};
  const std::vector<int> numbers = spread_views(sequence.num_views());
  if (stands_still(sequence, numbers)) return {};
  std::vector<AlignmentView> kept;
  std::vector<AlignmentTarget> views;
  kept.reserve(numbers.size());
  for (const int v : numbers) {
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
  if (bias.is_significant()) remove_disparity_error(bias.per_m, frame);
}

}  // namespace resight
