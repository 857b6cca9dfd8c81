// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>

#include "resight/geometry/camera.hpp"
#include "resight/sensor/rgbd_frame.hpp"

namespace resight {

/// A plane in the camera frame: normal . p = offset. The normal faces the camera.
struct SupportPlane {
  Eigen::Vector3d normal = -Eigen::Vector3d::UnitZ();
  double offset_m = 0;
  [[nodiscard]] double signed_distance_m(const Eigen::Vector3d& p) const { return normal.dot(p) - offset_m; }
};

/// The point that a pixel shows, from the nearest pixel with depth within 6 px; camera frame.
[[nodiscard]] std::optional<Eigen::Vector3d> find_clicked_point(const RgbdFrame& frame, Pixel pixel);

/// The plane that most points within `radius_m` of a point lie on, of those planes that it lies on or before; found by
/// trying triples of points. The plane through the point that faces the camera if there is none. Deterministic.
[[nodiscard]] SupportPlane find_support_plane(const RgbdFrame& frame, const Eigen::Vector3d& point_in_camera,
                                              double radius_m);

}  // namespace resight
