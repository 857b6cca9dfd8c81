// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <limits>
#include <string>

#include "resight/core/image.hpp"
#include "resight/core/result.hpp"
#include "resight/geometry/camera.hpp"
#include "resight/geometry/limits.hpp"
#include "resight/geometry/rigid3.hpp"

namespace resight {

/// What is farther is no measurement: the background of a rendered image, or a mark for missing depth.
inline constexpr auto kMaxReturn_m = static_cast<float>(kMaxSceneCoordinate_m);

/// The depth that a file says; NaN unless it is positive and at most kMaxReturn_m.
[[nodiscard]] constexpr float depth_or_none(double z_m) {
  const float z = z_m > 0 && z_m <= kMaxReturn_m ? static_cast<float>(z_m) : 0.0F;
  return z > 0 ? z : std::numeric_limits<float>::quiet_NaN();
}

/// One RGB-D view: colour, depth registered to it, and the pose of the camera.
struct RgbdFrame {
  std::string name;  ///< Stem of the source file; unique in its sequence.
  Camera camera;
  Image<Rgb8> color;
  Image<float> depth_m;  ///< Along z, at most kMaxReturn_m. NaN means no return; values are never 0 or negative.
  Rigid3 world_from_camera;
};

/// Checks that the sizes agree, the intrinsics are valid, the pose is rigid, and each depth is NaN, or positive
/// and at most kMaxReturn_m. The error names the frame and the rule.
[[nodiscard]] Result<void> check_frame(const RgbdFrame& frame);

/// Whether the colours are those of a camera without chromaticity: r = g = b in every pixel, but for rounding.
[[nodiscard]] bool is_grey(const Image<Rgb8>& color);

/// Number of pixels with a depth measurement.
[[nodiscard]] std::size_t count_valid(const Image<float>& depth_m);

}  // namespace resight
