// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "resight/geometry/rigid3.hpp"

namespace resight {

/// A pose without rotation, at a position in metres: by default, 1 m in front of the camera.
inline Rigid3 pose_at(double x, double y = 0, double z = 1) { return Rigid3::from_translation({x, y, z}); }

}  // namespace resight
