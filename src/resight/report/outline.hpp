// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <vector>

#include "resight/geometry/camera.hpp"
#include "resight/geometry/point_cloud.hpp"

namespace resight {

/// Closed contours, in pixels, of a surface (object frame, points `voxel_m` apart) in an image, as draw_overlay() draws
/// them: of the whole projected surface, including occluded parts. Empty if no part is in the image.
[[nodiscard]] std::vector<std::vector<Pixel>> find_outline(const Camera& camera, const Rigid3& camera_from_object,
                                                           const PointCloud& surface, double voxel_m);

}  // namespace resight
