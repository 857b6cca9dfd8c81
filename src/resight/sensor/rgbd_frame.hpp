// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>

#include "resight/core/image.hpp"
#include "resight/core/result.hpp"
#include "resight/geometry/camera.hpp"
#include "resight/geometry/rigid3.hpp"

namespace resight {

/// One RGB-D view: colour and depth registered to it, and where the camera stood.
struct RgbdFrame {
  std::string name;  ///< Stem of the file it came from; unique in its sequence.
  Camera camera;
  Image<Rgb8> color;
  Image<float> depth_m;  ///< Along z; NaN = no return. Never 0, negative or infinite.
  Rigid3 world_from_camera;
};

/// Sizes agree, intrinsics are valid, the pose is rigid, the depth holds only NaN or positive finite values.
/// The error names the frame and the rule.
[[nodiscard]] Result<void> check_frame(const RgbdFrame& frame);

/// Number of pixels with a return.
[[nodiscard]] std::size_t count_valid(const Image<float>& depth_m);

}  // namespace resight
