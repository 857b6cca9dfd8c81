// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace resight {

// Limits for numbers in files. A float at the limit is still exact enough for what it means, and every pixel and voxel
// that is computed from it fits into an integer.

/// Largest coordinate of a point of an object in the frame of the object.
inline constexpr double kMaxObjectCoordinate_m = 100;
/// Largest coordinate of a pose: a camera or an object in a scene.
inline constexpr double kMaxSceneCoordinate_m = 10000;

}  // namespace resight
