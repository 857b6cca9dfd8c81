// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>

#include "resight/core/options.hpp"
#include "resight/geometry/camera.hpp"

namespace resight {

/// Radial distortion that is left after calibration: the pixel at radius r shows what the ideal pixel at
/// r (1 + k1 r^2 + k2 r^4) would show, with r = 1 at an angle of 45 deg (Brown 1971).
struct ResidualDistortion {
  double k1 = 0;
  double k2 = 0;
  void check() const { check_options("ResidualDistortion", *this); }
};

inline void declare(OptionVisitor& v, ResidualDistortion& o) {
  v.field("k1", o.k1, between(-0.2, 0.2), "Coefficient of r^2. 0.01 moves the corner of a Kinect's image by 2.3 px.",
          "Brown 1971");
  v.field("k2", o.k2, between(-0.2, 0.2), "Coefficient of r^4.", "Brown 1971");
}

/// The ideal pixel that a pixel of the distorted image shows.
[[nodiscard]] inline Eigen::Vector2d ideal_pixel(const ResidualDistortion& lens, const Camera& camera, double u,
                                                 double v) {
  const double x = (u - camera.cx) / camera.fx;
  const double y = (v - camera.cy) / camera.fy;
  const double r_sq = x * x + y * y;
  const double factor = 1 + r_sq * (lens.k1 + lens.k2 * r_sq);
  return {camera.cx + camera.fx * x * factor, camera.cy + camera.fy * y * factor};
}

}  // namespace resight
