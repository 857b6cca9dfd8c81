// SPDX-License-Identifier: Apache-2.0
#include "resight/inspection/depth_values.hpp"

#include <Eigen/Core>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

#include "resight/core/statistics.hpp"
#include "resight/sensor/noise_model.hpp"

namespace resight {
namespace {

constexpr double kNoValue = std::numeric_limits<double>::quiet_NaN();
constexpr int kBlockRadius_px = 4;
constexpr int kBlockSpacing_px = 16;
constexpr std::size_t kMinBlocks = 20;
constexpr double kLeastNearShare = 0.05;

double step_of_levels(const std::vector<float>& levels, double near_m, double far_m) {
  std::vector<double> steps_m;
  for (std::size_t i = 1; i < levels.size(); ++i)
    if (levels[i - 1] >= near_m && levels[i] <= far_m)
      steps_m.push_back(static_cast<double>(levels[i]) - static_cast<double>(levels[i - 1]));
  return upper_median(std::move(steps_m));
}

bool are_eight_bits(const std::vector<float>& levels) {
  constexpr std::size_t kMinLevels = 8;  // With fewer, equal steps say little.
  constexpr double kTolerance = 0.05;    // Of a step; single precision is far better.
  constexpr double kMinUnit_m = 0.0015;  // At close range, files in millimetres have as few levels.
  if (levels.size() < kMinLevels) return false;
  double unit_m = levels.front();
  for (std::size_t i = 1; i < levels.size(); ++i)
    unit_m = std::min(unit_m, static_cast<double>(levels[i]) - levels[i - 1]);
  if (unit_m < kMinUnit_m || levels.back() > 256.5 * unit_m) return false;
  return std::ranges::all_of(levels, [&](float level_m) {
    const double steps = level_m / unit_m;
    return std::abs(steps - std::round(steps)) < kTolerance;
  });
}

/// Standard deviation of depth around the plane that fits the block best; none if a pixel is not measured.
std::optional<double> deviation_from_plane(const Image<float>& depth_m, int center_u, int center_v) {
  Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
  Eigen::Vector3d right = Eigen::Vector3d::Zero();
  double sum_sq = 0;
  for (int dv = -kBlockRadius_px; dv <= kBlockRadius_px; ++dv)
    for (int du = -kBlockRadius_px; du <= kBlockRadius_px; ++du) {
      const double z_m = depth_m(center_u + du, center_v + dv);
      if (std::isnan(z_m)) return std::nullopt;
      const Eigen::Vector3d row(du, dv, 1);
      // Around the centre's inverse depth, because the sums of squares would cancel otherwise.
      const double inverse = 1 / z_m - 1 / static_cast<double>(depth_m(center_u, center_v));
      normal += row * row.transpose();
      right += row * inverse;
      sum_sq += inverse * inverse;
    }
  const Eigen::Vector3d plane = normal.inverse() * right;
  constexpr double kFree = (2 * kBlockRadius_px + 1) * (2 * kBlockRadius_px + 1) - 3;
  const double z_m = depth_m(center_u, center_v);
  return z_m * z_m * std::sqrt(std::max(0.0, sum_sq - plane.dot(right)) / kFree);
}

}  // namespace

DepthValues measure_depth_values(const Image<float>& depth_m) {
  DepthValues values;
  std::vector<float> depths;
  for (const float z_m : depth_m.data())
    if (!std::isnan(z_m)) depths.push_back(z_m);
  values.near_m = values.median_m = values.far_m = values.step_m = kNoValue;
  if (depth_m.size() == 0) return values;
  values.measured_share = static_cast<double>(depths.size()) / static_cast<double>(depth_m.size());
  if (depths.empty()) return values;
  std::ranges::sort(depths);
  const auto at_share = [&](double share) {
    return static_cast<double>(depths[static_cast<std::size_t>(share * static_cast<double>(depths.size() - 1))]);
  };
  values.near_m = at_share(kLeastNearShare);
  values.median_m = at_share(0.5);
  values.far_m = at_share(1 - kLeastNearShare);
  depths.erase(std::unique(depths.begin(), depths.end()), depths.end());
  values.num_levels = static_cast<int>(depths.size());
  values.step_m = step_of_levels(depths, values.near_m, values.far_m);
  values.has_eight_bits = are_eight_bits(depths);
  return values;
}

double measure_noise_ratio(const Image<float>& depth_m, double focal_px) {
  std::vector<double> ratios;
  for (int v = kBlockRadius_px; v + kBlockRadius_px < depth_m.height(); v += kBlockSpacing_px)
    for (int u = kBlockRadius_px; u + kBlockRadius_px < depth_m.width(); u += kBlockSpacing_px) {
      const std::optional<double> sigma_m = deviation_from_plane(depth_m, u, v);
      if (sigma_m) ratios.push_back(*sigma_m / nguyen_noise(depth_m(u, v), 0, focal_px).axial_m);
    }
  return ratios.size() < kMinBlocks ? kNoValue : upper_median(std::move(ratios));
}

}  // namespace resight
