// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>

#include "resight/geometry/camera.hpp"
#include "resight/models/object_model.hpp"
#include "resight/sensor/rgbd_frame.hpp"

namespace resight {

/// Places an object where the user has clicked on it, or on the surface that it is to stand on. The object stands on
/// the plane below the click with one of its six axes upwards; which one, and the rotation about it, are those that
/// depth and colours of the view support best. Without a plane, the surface at the click takes its place. None if the
/// pixel has no depth nearby. Deterministic. Throws std::invalid_argument for a pixel outside the image or a model
/// without normals.
[[nodiscard]] std::optional<Rigid3> place_by_click(const ObjectModel& model, double surface_voxel_m,
                                                   const RgbdFrame& frame, Pixel pixel);

}  // namespace resight
