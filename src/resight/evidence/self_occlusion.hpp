// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <limits>
#include <span>
#include <vector>

namespace resight {

/// A surface point in a view.
struct ProjectedPoint {
  float u = 0;               ///< px
  float v = 0;               ///< px
  float z = -1;              ///< Metres; not positive: behind the camera.
  float viewing_cosine = 1;  ///< Between normal and viewing ray; 1 where the normal is not known.
};

/// Finds the points of a surface that the surface itself hides: a z-buffer of its points, whose cells are about as wide
/// as the spacing of the points, so that a closed surface has no holes.
class SelfOcclusion {
 public:
  static constexpr float kMinDepth_m = 1e-3F;  ///< Nearer points neither hide nor are hidden.
  /// `spacing_m`: between neighbours.
  SelfOcclusion(std::span<const ProjectedPoint> points, float focal_px, float spacing_m);
  /// Of one of the points, before the camera.
  [[nodiscard]] bool hides(const ProjectedPoint& p) const;

 private:
  [[nodiscard]] int cell(float px) const { return static_cast<int>(px * inverse_cell_); }
  [[nodiscard]] std::size_t index(const ProjectedPoint& p) const {
    return static_cast<std::size_t>(cell(p.v - min_v_)) * static_cast<std::size_t>(width_) +
           static_cast<std::size_t>(cell(p.u - min_u_));
  }

  float spacing_m_;
  float inverse_cell_ = 1;
  float cell_per_depth_ = 0;
  float min_u_ = std::numeric_limits<float>::infinity();
  float min_v_ = std::numeric_limits<float>::infinity();
  int width_ = 0;
  std::vector<float> nearest_;  // Smallest z per cell.
};

}  // namespace resight
