// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <functional>

#include "resight/geometry/rigid3.hpp"

namespace resight {

/// What change detection found on the surface of an object at a place.
enum class PlaceChange : std::uint8_t { kNone, kCame, kLeft };

/// The last change at the place of an object (index into the ModelLibrary). What left up to `seen_view`, the last view
/// that showed the object there, does not count.
using FindPlaceChange = std::function<PlaceChange(int object, const Rigid3& world_from_object, int seen_view)>;

}  // namespace resight
