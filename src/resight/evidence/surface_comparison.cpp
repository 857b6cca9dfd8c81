// SPDX-License-Identifier: Apache-2.0
#include "resight/evidence/internal/surface_comparison.hpp"

#include <cmath>

namespace resight {
namespace {

constexpr float kMinViewingCosine = 0.05F;  // 87 deg: at more grazing angles depth says nothing about a surface.

}  // namespace

/// Passes pointers as parameters, because compilers honour __restrict only there; otherwise the loop is not vectorised.
void reproject(const Reprojection& to, int num, const float* __restrict x, const float* __restrict y,
               const float* __restrict z, const float* __restrict nx, const float* __restrict ny,
               const float* __restrict nz, const float* __restrict sigma_m, float* __restrict out_z_m,
               float* __restrict out_slope, float* __restrict out_variance, int* __restrict out_u,
               int* __restrict out_v) {
  const Eigen::Matrix3f r = to.view_from_surfaces.rotation;
  const Eigen::Vector3f t = to.view_from_surfaces.translation;
  for (int i = 0; i < num; ++i) {
    const float px = r(0, 0) * x[i] + r(0, 1) * y[i] + r(0, 2) * z[i] + t[0];
    const float py = r(1, 0) * x[i] + r(1, 1) * y[i] + r(1, 2) * z[i] + t[1];
    const float pz = r(2, 0) * x[i] + r(2, 1) * y[i] + r(2, 2) * z[i] + t[2];
    const float along_x = (r(0, 0) * nx[i] + r(0, 1) * ny[i] + r(0, 2) * nz[i]) * px;
    const float along_y = (r(1, 0) * nx[i] + r(1, 1) * ny[i] + r(1, 2) * nz[i]) * py;
    const float along_z = (r(2, 0) * nx[i] + r(2, 1) * ny[i] + r(2, 2) * nz[i]) * pz;
    const float slope = std::abs(along_x + along_y + along_z) / pz;
    const float u = to.fx * px / pz + to.left_px;
    const float v = to.fy * py / pz + to.top_px;
    const bool has_normal = slope == slope;
    const bool is_visible = (pz > 0) & (!has_normal | (slope > kMinViewingCosine)) & (u >= 0) & (v >= 0) &
                            (u < to.width_px) & (v < to.height_px);  // false for NaN
    out_z_m[i] = pz;
    out_slope[i] = has_normal ? slope : 1.0F;
    out_variance[i] = sigma_m[i] * sigma_m[i];
    out_u[i] = static_cast<int>(is_visible ? u : -1.0F);
    out_v[i] = static_cast<int>(is_visible ? v : -1.0F);
  }
}

}  // namespace resight
