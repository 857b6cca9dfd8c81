// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "resight/sensor/training_view.hpp"

namespace resight {

/// The part of a view that holds its object: the bounding box of the mask and `margin_px` around it, within the image.
/// The principal point moves along, so that every pixel keeps its ray and its 3-D point. A view with an empty mask
/// gives an empty one (no pixels).
[[nodiscard]] TrainingView crop_to_object(const TrainingView& view, int margin_px);

}  // namespace resight
