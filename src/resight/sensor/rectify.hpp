// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "resight/core/image.hpp"
#include "resight/geometry/camera.hpp"
#include "resight/geometry/lens.hpp"
#include "resight/geometry/rigid3.hpp"

namespace resight {

/// The image that the same camera would take without distortion. Bilinear; black where the original has no pixel.
[[nodiscard]] Image<Rgb8> undistort_color(const Image<Rgb8>& color, const Camera& camera, const LensDistortion& lens);
/// Same for depth: the nearest pixel, because a mean of two surfaces is no surface. NaN where there is none.
[[nodiscard]] Image<float> undistort_depth(const Image<float>& depth_m, const Camera& camera,
                                           const LensDistortion& lens);

/// Depth as the colour camera would measure it. Both cameras are without distortion. Each depth pixel covers the colour
/// pixels between its projected corners, and the nearest surface wins; the other pixels are NaN, no return.
[[nodiscard]] Image<float> register_depth(const Image<float>& depth_m, const Camera& depth_camera,
                                          const Rigid3& color_from_depth, const Camera& color_camera);

}  // namespace resight
