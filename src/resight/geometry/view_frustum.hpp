// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>

#include "resight/geometry/camera.hpp"

namespace resight {

/// The four sides of a view volume as slopes x/z and y/z, and its depth range. Precomputed from ViewFrustum for loops
/// over points.
struct FrustumLimits {
  float min_x_over_z, max_x_over_z;
  float min_y_over_z, max_y_over_z;
  float min_depth_m, max_depth_m;

  /// Whether the point is strictly inside; false for NaN.
  [[nodiscard]] bool contains(const Eigen::Vector3f& p_in_camera) const {
    const float z = p_in_camera.z();
    return z > min_depth_m && z < max_depth_m && p_in_camera.x() > min_x_over_z * z &&
           p_in_camera.x() < max_x_over_z * z && p_in_camera.y() > min_y_over_z * z &&
           p_in_camera.y() < max_y_over_z * z;
  }
};

/// The view volume of a camera, Eq. (5). The paper prints a sine of the full field of view without a sign test. We
/// compare the angles of a point with those of the image borders less a margin, and require z within (min_depth_m,
/// max_depth_m).
struct ViewFrustum {
  Camera camera;
  double min_depth_m = 0.5;       ///< Paper's code: 0.5 (Xtion).
  double max_depth_m = 3.5;       ///< Paper's code: 3.5.
  double margin_rad = 0.0872665;  ///< On each side. Paper's code: 5 deg.

  /// Throws std::invalid_argument for an invalid camera, range or margin.
  void check() const;
  /// The sides from the intrinsics. Left and right differ if the principal point is not in the middle. Calls check().
  /// If the margin leaves nothing, the limits contain no point.
  [[nodiscard]] FrustumLimits limits() const;
  /// Whether the point is strictly inside; false for NaN. Throws as check(). For many points, store limits() instead.
  [[nodiscard]] bool contains(const Eigen::Vector3f& p_in_camera) const;
};

}  // namespace resight
