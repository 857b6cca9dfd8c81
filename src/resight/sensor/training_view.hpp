// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "resight/sensor/rgbd_frame.hpp"

namespace resight {

/// A registered view of an object for training. frame.world_from_camera is object_from_camera.
struct TrainingView {
  RgbdFrame frame;
  Image<std::uint8_t> mask;  ///< Non-zero marks the object.
};

}  // namespace resight
