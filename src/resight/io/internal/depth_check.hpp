// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "resight/core/result.hpp"
#include "resight/sensor/rgbd_frame.hpp"

namespace resight::io {

/// Fails if the median depth of a view is that of no RGB-D camera: the unit is wrong. A view without depth passes.
[[nodiscard]] Result<void> check_depth_unit(const RgbdFrame& frame);

}  // namespace resight::io
