// SPDX-License-Identifier: Apache-2.0
#include "resight/geometry/view_frustum.hpp"

#include <cmath>
#include <numbers>

#include "resight/core/check.hpp"

namespace resight {
namespace {

struct SlopeRange {
  float min;
  float max;
};

/// Range of slopes seen by the pixels from -0.5 to `size` - 0.5, less `margin_rad` on both sides.
SlopeRange slope_range(int size, double focal_px, double center_px, double margin_rad) {
  const double min_rad = std::atan((-0.5 - center_px) / focal_px) + margin_rad;
  const double max_rad = std::atan((size - 0.5 - center_px) / focal_px) - margin_rad;
  // A large margin can move an angle out of (-pi/2, pi/2), where the tangent changes its sign.
  if (min_rad >= max_rad) return {1.0F, -1.0F};
  return {static_cast<float>(std::tan(min_rad)), static_cast<float>(std::tan(max_rad))};
}

}  // namespace

void ViewFrustum::check() const {
  require(camera.is_valid(),
          "ViewFrustum.camera: invalid intrinsics (size and focal lengths must be positive and finite)");
  check_not_negative("ViewFrustum.min_depth_m", min_depth_m);
  require(std::isfinite(max_depth_m) && max_depth_m > min_depth_m,
          "ViewFrustum.max_depth_m (must be finite and > min_depth_m)");
  check_in_range("ViewFrustum.margin_rad", margin_rad, 0.0, std::numbers::pi / 2);
}

FrustumLimits ViewFrustum::limits() const {
  check();
  const SlopeRange x = slope_range(camera.width, camera.fx, camera.cx, margin_rad);
  const SlopeRange y = slope_range(camera.height, camera.fy, camera.cy, margin_rad);
  return {x.min, x.max, y.min, y.max, static_cast<float>(min_depth_m), static_cast<float>(max_depth_m)};
}

bool ViewFrustum::contains(const Eigen::Vector3f& p_in_camera) const { return limits().contains(p_in_camera); }

}  // namespace resight
