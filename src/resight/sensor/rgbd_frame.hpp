// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>

#include "resight/core/image.hpp"
#include "resight/core/result.hpp"
#include "resight/geometry/camera.hpp"
#include "resight/geometry/rigid3.hpp"

namespace resight {

/// One RGB-D view: colour, depth registered to it, and the pose of the camera.
struct RgbdFrame {
  std::string name;  ///< Stem of the source file; unique in its sequence.
  Camera camera;
  Image<Rgb8> color;
  Image<float> depth_m;  ///< Along z. NaN means no return; values are never 0, negative or infinite.
  Rigid3 world_from_camera;
};

/// Checks that the sizes agree, the intrinsics are valid, the pose is rigid, and each depth is NaN or positive and
/// finite. The error names the frame and the rule.
[[nodiscard]] Result<void> check_frame(const RgbdFrame& frame);

/// Number of pixels with a depth measurement.
[[nodiscard]] std::size_t count_valid(const Image<float>& depth_m);

}  // namespace resight
