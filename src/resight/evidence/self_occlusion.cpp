// SPDX-License-Identifier: Apache-2.0
#include "resight/evidence/self_occlusion.hpp"

#include <algorithm>
#include <cmath>

namespace resight {
namespace {

constexpr int kMaxBufferCells = 1 << 20;
constexpr float kCellSpacings = 1.5F;
constexpr float kMinCosine = 0.05F;  // 87 deg: bounds the slope.

}  // namespace

SelfOcclusion::SelfOcclusion(std::span<const ProjectedPoint> points, float focal_px, float spacing_m)
    : spacing_m_(spacing_m) {
  float min_z = std::numeric_limits<float>::infinity();
  float max_u = -std::numeric_limits<float>::infinity();
  float max_v = -std::numeric_limits<float>::infinity();
  for (const ProjectedPoint& p : points)
    if (p.z > kMinDepth_m) {
      min_z = std::min(min_z, p.z);
      min_u_ = std::min(min_u_, p.u);
      min_v_ = std::min(min_v_, p.v);
      max_u = std::max(max_u, p.u);
      max_v = std::max(max_v, p.v);
    }
  if (!(min_z < std::numeric_limits<float>::infinity())) return;
  float cell_px = std::max(1.0F, kCellSpacings * spacing_m * focal_px / min_z);
  const float area = (max_u - min_u_ + 1) * (max_v - min_v_ + 1);
  cell_px = std::max(cell_px, std::sqrt(area / kMaxBufferCells));
  inverse_cell_ = 1 / cell_px;
  cell_per_depth_ = cell_px / focal_px;
  width_ = cell(max_u - min_u_) + 1;
  nearest_.assign(static_cast<std::size_t>(width_) * static_cast<std::size_t>(cell(max_v - min_v_) + 1),
                  std::numeric_limits<float>::infinity());
  for (const ProjectedPoint& p : points)
    if (p.z > kMinDepth_m) nearest_[index(p)] = std::min(nearest_[index(p)], p.z);
}

// The depth of an oblique surface changes within a cell by cell * tan(angle): that much is no occlusion.
bool SelfOcclusion::hides(const ProjectedPoint& p) const {
  if (!(p.z > kMinDepth_m)) return false;
  const float cosine = std::max(p.viewing_cosine, kMinCosine);
  const float slope = std::sqrt(std::max(0.0F, 1 - cosine * cosine)) / cosine;
  return p.z > nearest_[index(p)] + spacing_m_ + kCellSpacings * cell_per_depth_ * p.z * slope;
}

}  // namespace resight
