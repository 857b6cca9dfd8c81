// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>

#include "resight/geometry/camera.hpp"

namespace resight {

/// The view volume of a camera, Eq. (5). The paper prints a sine against the full field of view, without a sign test; we test
/// the angles of a point against what the intrinsics see, less a margin, and z within (min_depth_m, max_depth_m).
struct ViewFrustum {
  Camera camera;
  double min_depth_m = 0.5;       ///< Paper's code: 0.5 (Xtion).
  double max_depth_m = 3.5;       ///< Paper's code: 3.5.
  double margin_rad = 0.0872665;  ///< Off each side; paper's code: 5 deg.

  /// Throws std::invalid_argument for an invalid camera, range or margin.
  void check() const;
  /// Strictly inside; false for NaN.
  [[nodiscard]] bool contains(const Eigen::Vector3f& p_in_camera) const;
};

}  // namespace resight
