// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "resight/sensor/training_view.hpp"

namespace resight {

/// Crops a view to its object: the bounding box of the mask, enlarged by `margin_px` on each side, within the image.
/// The principal point moves with the crop, so that each pixel keeps its ray and its 3-D point. A view with an empty
/// mask becomes empty (no pixels).
[[nodiscard]] TrainingView crop_to_object(const TrainingView& view, int margin_px);

}  // namespace resight
